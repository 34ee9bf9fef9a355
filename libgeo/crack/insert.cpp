#include "crack/insert.h"

#include <algorithm>
#include <cmath>

#include "crack/classify.h"
#include "crack/guard.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo::crack {
namespace {

// The new faces of the edit by the triangle that each is a part of: cut faces of K first, then the
// strip's triangles.
std::vector<Family> families_of(const Complex& complex, const Arrangement& arrangement, std::span<const Part> parts) {
  std::vector<Family> families;
  std::uint32_t row = 0, last = ~0u;
  for (std::uint32_t e = arrangement.strip_size; e < arrangement.elements.size(); ++e)
    if (const auto& element = arrangement.elements[e]; element.cut) {
      families.push_back({complex.corners(element.face), row, row + element.end - element.first, {}, true});
      row = families.back().end;
    }
  const auto& points = arrangement.points();
  for (const auto& part : parts) {
    const auto& element = arrangement.elements[part.element];
    const auto& c = element.corner;
    if (last != part.element) {
      families.push_back({{points[c[0]], points[c[1]], points[c[2]]}, row, row, arrangement.near(part.element), true});
      const auto [axis, turn] = view_of(points, c);
      for (auto i = element.first; i < element.end && families.back().whole; ++i) {
        const auto& v = arrangement.children[i].v;
        families.back().whole = orient2d(points[v[0]], points[v[1]], points[v[2]], axis) == turn;
      }
    }
    last = part.element;
    families.back().end = ++row;
  }
  return families;
}

// Where the new front's line runs outside, from a new vertex of K or to one: what is neither an
// edge of the strip's kept parts nor on K.
std::vector<Exit> exits_of(const Complex& complex, const Strip& strip, const Arrangement& arrangement,
                           const EdgeTable& edges, std::span<const Part> parts, std::span<const VertexId> vertex) {
  const auto fresh = [&](VertexId v) { return v.valid() && v.value >= complex.vertex_count(); };
  std::vector<Use> on_k;
  std::vector<Exit> exits;
  std::vector<Local> kept;  // of the pieces that kept parts have, those ends that come first in the chain
  for (std::uint32_t t = 0; t < arrangement.strip_size; ++t)
    for (std::uint8_t k = 0; k < 3; ++k) {
      if (strip.triangles[t].segment[k] < 0) continue;
      const auto chain = arrangement.along_edge(t, k);
      kept.clear();
      for (auto part = std::lower_bound(parts.begin(), parts.end(), t,
                                        [](const Part&p, std::uint32_t e) { return p.element < e; });
           part != parts.end() && part->element == t; ++part) {
        const Child& child = arrangement.children[part->child];
        for (std::size_t e = 0; e < 3; ++e)
          if (child.edge[e] == k) kept.push_back(child.v[e]);
      }
      std::sort(kept.begin(), kept.end());
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const VertexId u = vertex[chain[i]], v = vertex[chain[i + 1]];
        if (!fresh(u) && !fresh(v)) continue;
        edges.find(chain[i], chain[i + 1], on_k);
        if (!on_k.empty() || std::binary_search(kept.begin(), kept.end(), chain[i])) continue;
        const auto [from, to] = u.valid() ? std::pair(i, i + 1) : std::pair(i + 1, i);
        exits.push_back({vertex[chain[from]], arrangement.points()[chain[to]], vertex[chain[to]], arrangement.near(t)});
      }
    }
  return exits;
}

}  // namespace

Attempt attempt_at(int number, const CrackOptions& options, double size) {
  return {number == 0 ? 0 : options.jitter * size * std::pow(8.0, std::min(number - 1, 4)),
          2 * number <= options.attempts ? options.clearance * size : 0};
}

CrackDelta insert_strip(Complex& complex, const Strip& strip, Arrangement& arrangement, std::int32_t crack,
                        std::vector<VertexId>& vertex, double clearance, CrackStats& work) {
  vertex.clear();
  if (strip.triangles.empty()) {
    for (Local l = 0; l < arrangement.points().size(); ++l) vertex.push_back(arrangement.id(l));
    return {};
  }
  Stopwatch watch;
  arrangement.meet(work);
  work.meet_seconds += watch.lap();
  arrangement.split();
  work.split_seconds += watch.lap();
  Box3 box;
  for (const Vec3& p : strip.points) box.add(p);
  if (!box.meets(complex.extent())) {  // divided by itself alone, and nothing to keep
    vertex.assign(arrangement.points().size(), VertexId());
    return {};
  }
  const EdgeTable edges = edges_of_complex(arrangement);
  const auto parts = keep_inside(arrangement, complex, edges);
  work.keep_seconds += watch.lap();
  if (parts.empty()) {
    // Nothing of the strip is in the material: contacts are those vertices of K that the front
    // happens to stand on.
    for (Local l = 0; l < arrangement.points().size(); ++l) vertex.push_back(arrangement.id(l));
    return {};
  }
  ComplexEdit edit = stitch(arrangement, complex, edges, parts, crack, vertex);
  work.stitch_seconds += watch.lap();
  const auto families = families_of(complex, arrangement, parts);
  std::vector<std::uint8_t> moved(edit.new_vertices.size());
  for (Local l = 0; l < vertex.size(); ++l)
    if (vertex[l].valid() && vertex[l].value >= complex.vertex_count())
      moved[vertex[l].value - complex.vertex_count()] = arrangement.points().error(l) > 0;
  std::vector<Exit> exits;
  if (clearance > 0) exits = exits_of(complex, strip, arrangement, edges, parts, vertex);
  if (const Fault fault = repair(complex, edit, families, moved, clearance, exits, work.repairs))
    throw GeometryError(fault.what);
  work.guard_seconds += watch.lap();
  CrackDelta delta = complex.apply(edit);
  work.triangles_cut += edit.removed_faces.size();
  work.new_crack_faces += parts.size();
  work.stitch_seconds += watch.lap();
  return delta;
}

}  // namespace geo::crack
