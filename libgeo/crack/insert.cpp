// The phases of one attempt in order. Exact intersections and classification come first; new points
// are rounded to doubles at the end, and the guard checks or repairs the rounded edit.
#include "crack/insert.h"

#include <algorithm>
#include <cmath>

#include "crack/classify.h"
#include "crack/guard.h"
#include "crack/stitch.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo::crack {
namespace {

// The new faces of the edit by the triangle that contains them: cut faces of K first, then the
// strip's triangles.
std::vector<Family> families_of(const Complex& complex, const Arrangement& arrangement,
                                std::span<const ChildRef> kept) {
  std::vector<Family> families;
  std::uint32_t count = 0, last = ~0u;
  for (std::uint32_t e = arrangement.strip_size; e < arrangement.elements.size(); ++e)
    if (const auto& element = arrangement.elements[e]; element.cut) {
      families.push_back({.plane = complex.corners(element.face),
                          .first = count,
                          .end = count + element.end - element.first,
                          .near = {},
                          .near_known = false,
                          .whole = true});
      count = families.back().end;
    }
  const auto& points = arrangement.points();
  for (const auto& ref : kept) {
    const auto& element = arrangement.elements[ref.element];
    const auto& c = element.corner;
    if (last != ref.element) {
      families.push_back({.plane = {points[c[0]], points[c[1]], points[c[2]]},
                          .first = count,
                          .end = count,
                          .near = arrangement.near(ref.element),
                          .near_known = true,
                          .whole = true});
      const auto [axis, turn] = projection_of(points, c);
      for (auto i = element.first; i < element.end && families.back().whole; ++i) {
        const auto& v = arrangement.children[i].v;
        families.back().whole = orient2d(points[v[0]], points[v[1]], points[v[2]], axis) == turn;
      }
    }
    last = ref.element;
    families.back().end = ++count;
  }
  return families;
}

// For each piece of the new front's line on edge k of strip triangle t that is an edge of a kept
// child: its end that comes first in the chain. Ascending.
void find_kept_pieces(const Arrangement& arrangement, std::span<const ChildRef> kept, std::uint32_t t, std::uint8_t k,
                      std::vector<PointIndex>& out) {
  out.clear();
  const auto before = [](const ChildRef& ref, std::uint32_t e) { return ref.element < e; };
  for (auto ref = std::lower_bound(kept.begin(), kept.end(), t, before); ref != kept.end() && ref->element == t;
       ++ref) {
    const Child& child = arrangement.children[ref->child];
    for (std::size_t e = 0; e < 3; ++e)
      if (child.edge[e] == k) out.push_back(child.v[e]);
  }
  std::sort(out.begin(), out.end());
}

// The pieces of the new front's line outside the material, from or to a new vertex of K. A piece is
// outside if it is neither an edge of a kept child nor on K.
std::vector<FrontExit> exits_of(const Complex& complex, const Strip& strip, const Arrangement& arrangement,
                                const EdgeTable& edges, std::span<const ChildRef> kept,
                                std::span<const VertexId> vertex) {
  const auto is_new = [&](VertexId v) { return v.valid() && v.value >= complex.vertex_count(); };
  std::vector<EdgeUse> on_k;
  std::vector<FrontExit> exits;
  std::vector<PointIndex> inside;
  for (std::uint32_t t = 0; t < arrangement.strip_size; ++t)
    for (std::uint8_t k = 0; k < 3; ++k) {
      if (strip.triangles[t].segment[k] < 0) continue;
      const auto chain = arrangement.along_edge(t, k);
      find_kept_pieces(arrangement, kept, t, k, inside);
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const VertexId u = vertex[chain[i]], v = vertex[chain[i + 1]];
        if (!is_new(u) && !is_new(v)) continue;
        edges.find(chain[i], chain[i + 1], on_k);
        if (!on_k.empty() || std::binary_search(inside.begin(), inside.end(), chain[i])) continue;
        const auto [from, to] = u.valid() ? std::pair(i, i + 1) : std::pair(i + 1, i);
        exits.push_back({.from = vertex[chain[from]],
                         .to = arrangement.points()[chain[to]],
                         .at = vertex[chain[to]],
                         .near = arrangement.near(t)});
      }
    }
  return exits;
}

// The vertices of K at points of the arrangement, where no part of the strip is inserted.
std::vector<VertexId> known_vertices(const Arrangement& arrangement) {
  std::vector<VertexId> vertex;
  for (PointIndex l = 0; l < arrangement.points().size(); ++l) vertex.push_back(arrangement.id(l));
  return vertex;
}

}  // namespace

Attempt attempt_at(int number, const CrackOptions& options, double size) {
  // By default 1e-9 … 8⁴ · 1e-9 ≈ 4e-6 of the model's size. Half of the attempts insist on the
  // clearance (docs/decisions/005).
  return {number == 0 ? 0 : options.jitter * size * std::pow(8.0, std::min(number - 1, 4)),
          2 * number <= options.attempts ? options.clearance * size : 0};
}

CrackDelta insert_strip(Complex& complex, const Strip& strip, Arrangement& arrangement, std::int32_t crack,
                        std::vector<VertexId>& vertex, std::optional<double> clearance, CrackStats& stats) {
  if (strip.triangles.empty()) {
    vertex = known_vertices(arrangement);
    return {};
  }
  Stopwatch watch;
  arrangement.meet(stats);
  stats.meet_seconds += watch.lap();
  arrangement.split();
  stats.split_seconds += watch.lap();
  Box3 box;
  for (const Vec3& p : strip.points) box.add(p);
  if (!box.meets(complex.extent())) {  // outside; only divided by itself
    vertex.assign(arrangement.points().size(), VertexId());
    return {};
  }
  const EdgeTable edges = edges_of_complex(arrangement);
  const auto kept = children_in_material(arrangement, complex, edges);
  stats.keep_seconds += watch.lap();
  if (kept.empty()) {
    vertex = known_vertices(arrangement);  // contacts where the front happens to touch vertices of K
    return {};
  }
  ComplexEdit edit = stitch(arrangement, complex, edges, kept, crack, vertex);
  stats.stitch_seconds += watch.lap();
  if (clearance) {
    const auto families = families_of(complex, arrangement, kept);
    std::vector<std::uint8_t> moved(edit.new_vertices.size());
    for (PointIndex l = 0; l < vertex.size(); ++l)
      if (vertex[l].valid() && vertex[l].value >= complex.vertex_count())
        moved[vertex[l].value - complex.vertex_count()] = arrangement.points().error(l) > 0;
    std::vector<FrontExit> exits;
    if (*clearance > 0) exits = exits_of(complex, strip, arrangement, edges, kept, vertex);
    if (const Fault fault =
            snap_repair(complex, edit, {.families = families, .moved = moved, .clearance = *clearance, .exits = exits},
                        stats.repairs, arrangement.pause()))
      throw GeometryError(fault.what);
    stats.guard_seconds += watch.lap();
  }
  CrackDelta delta = complex.apply(edit);
  stats.triangles_cut += edit.removed_faces.size();
  stats.new_crack_faces += kept.size();
  stats.stitch_seconds += watch.lap();
  return delta;
}

}  // namespace geo::crack
