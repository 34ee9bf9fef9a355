#include "crack/insert_internal.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/stopwatch.h"
#include "crack/guard.h"
#include "crack/keep_internal.h"
#include "geometry/predicates.h"

namespace geo::crack {
namespace {

// The new faces of the edit by the triangle that each is a part of: cut faces of K first, then the strip's triangles.
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

}  // namespace

Attempt attempt_at(int number, const CrackOptions& options, double size) {
  return {number == 0 ? 0 : options.jitter * size * std::pow(8.0, std::min(number - 1, 4)), 2 * number <= options.attempts ? options.clearance * size : 0};
}

CrackDelta insert_strip(Complex& complex, const Strip& strip, Arrangement& arrangement, std::int32_t crack,
                        std::vector<VertexId>& vertex, double clearance, CrackWork& work) {
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
    // Nothing of the strip is in the material: contacts are those vertices of K that the front happens to stand on.
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
  if (const Fault fault = repair(complex, edit, families, moved, clearance, work.repairs)) throw GeometryError(fault.what);
  work.guard_seconds += watch.lap();
  CrackDelta delta = complex.apply(edit);
  work.triangles_cut += edit.removed_faces.size();
  work.new_crack_faces += parts.size();
  work.stitch_seconds += watch.lap();
  return delta;
}

}  // namespace geo::crack
