#include "crack/guard.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "geometry/predicates.h"
#include "surface/check.h"

namespace geo {

Fault find_fault(const Complex& complex, const ComplexEdit& edit, std::span<const Family> families,
                       std::span<const std::uint8_t> moved) {
  const auto point = [&](VertexId v) -> const Vec3& {
    return v.value < complex.vertex_count() ? complex.point(v) : edit.new_vertices[v.value - complex.vertex_count()];
  };
  const auto n = static_cast<std::uint32_t>(edit.new_faces.size());
  std::vector<std::array<Vec3, 3>> corners(n);
  std::vector<std::array<std::uint32_t, 3>> rows(n);
  std::vector<Box3> boxes(n);
  std::vector<std::uint8_t> touched(n, 0);  // has a vertex that rounding moved
  std::vector<std::uint32_t> family_of(n);  // ~0u: of a strip triangle, some of whose children may be missing
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) {
      const VertexId v = edit.new_faces[i].v[k];
      corners[i][k] = point(v), rows[i][k] = v.value;
      if (v.value >= complex.vertex_count()) touched[i] |= moved[v.value - complex.vertex_count()];
    }
    boxes[i] = box_of(corners[i][0], corners[i][1], corners[i][2]);
  }
  for (const Family& family : families) {
    const auto& p = family.plane;
    int axis = 0;
    (p[1] - p[0]).cross(p[2] - p[0]).cwiseAbs().maxCoeff(&axis);
    int was = orient2d(p[0], p[1], p[2], axis);
    for (int tries = 0; tries < 2 && was == 0; ++tries) axis = (axis + 1) % 3, was = orient2d(p[0], p[1], p[2], axis);
    for (auto i = family.first; i < family.end; ++i) {
      family_of[i] = edit.new_faces[i].parent.valid() ? family.first : ~0u;
      const int is = orient2d(corners[i][0], corners[i][1], corners[i][2], axis);
      if (is == 0) return {"rounding would leave a face without area", {i}};
      if (was != is) return {"rounding would turn a face over", {i}};
    }
  }

  // Vertices at one place: new ones among each other and against the corners of what is there.
  std::vector<VertexId> vertices;
  for (const auto& f : edit.new_faces) vertices.insert(vertices.end(), f.v.begin(), f.v.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::pair<double, VertexId>> by_x;
  for (const VertexId v : vertices) by_x.push_back({point(v).x(), v});
  std::sort(by_x.begin(), by_x.end());
  // Two that rounding has left a few places from each other would be slivers that no later step could round.
  const double close = 0x1p-48 * complex.extent().diagonal();
  const auto is_moved = [&](VertexId v) { return v.value >= complex.vertex_count() && moved[v.value - complex.vertex_count()]; };
  for (std::size_t i = 0; i < by_x.size(); ++i)
    for (std::size_t j = i + 1; j < by_x.size() && by_x[j].first <= by_x[i].first + close; ++j)
      if (((point(by_x[i].second) - point(by_x[j].second)).cwiseAbs().array() <= close).all() &&
          (is_moved(by_x[i].second) || is_moved(by_x[j].second))) {
        Fault fault{"rounding would leave two vertices at one place", {}};
        for (std::uint32_t f = 0; f < n; ++f)
          for (const VertexId v : edit.new_faces[f].v)
            if (v == by_x[i].second || v == by_x[j].second) fault.faces.push_back(f);
        return fault;
      }

  // New faces against those that stay.
  std::vector<FaceId> removed = edit.removed_faces, looked_up;
  std::sort(removed.begin(), removed.end());
  struct Near {
    FaceId face;
    Box3 box;
  };
  std::vector<Near> near;
  for (const Family& family : families) {
    Box3 box;
    for (auto i = family.first; i < family.end; ++i)
      if (touched[i]) box.add(boxes[i]);
    if (box.empty()) continue;
    near.clear();
    looked_up.clear();
    if (family.near.empty()) complex.near(box, looked_up);
    for (const FaceId f : family.near.empty() ? std::span<const FaceId>(looked_up) : family.near) {
      const Box3 there = complex.box(f);
      if (there.meets(box) && !std::binary_search(removed.begin(), removed.end(), f)) near.push_back({f, there});
    }
    for (auto i = family.first; i < family.end; ++i)
      for (const Near& other : near) {
        if (!touched[i] || !other.box.meets(boxes[i])) continue;
        const auto& v = complex.face(other.face).v;
        if (faces_cross(rows[i], corners[i], {v[0].value, v[1].value, v[2].value}, complex.corners(other.face)))
          return {"rounding would make a new face cross face " + std::to_string(other.face.value), {i}};
      }
  }

  // New faces among each other, swept along the longest way.
  Box3 all;
  for (const Box3& b : boxes) all.add(b);
  int axis = 0;
  if (n > 0) (all.hi - all.lo).maxCoeff(&axis);
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return boxes[i].lo[axis] != boxes[j].lo[axis] ? boxes[i].lo[axis] < boxes[j].lo[axis] : i < j; });
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n && boxes[order[j]].lo[axis] <= boxes[order[i]].hi[axis]; ++j) {
      const auto a = order[i], b = order[j];
      // All children of a face, none turned over: they cover it once, as before rounding.
      if (family_of[a] != ~0u && family_of[a] == family_of[b]) continue;
      if (!touched[a] && !touched[b]) continue;
      if (boxes[a].meets(boxes[b]) && faces_cross(rows[a], corners[a], rows[b], corners[b])) return {"rounding would make two new faces cross", {a, b}};
    }
  return {};
}

Fault repair(const Complex& complex, ComplexEdit& edit, std::span<const Family> families,
             std::span<const std::uint8_t> moved, std::size_t& repairs) {
  Fault fault = find_fault(complex, edit, families, moved);
  if (!fault) return fault;
  const double last_place = 0x1p-52 * (complex.extent().diagonal() + complex.extent().lo.cwiseAbs().cwiseMax(complex.extent().hi.cwiseAbs()).maxCoeff());
  Random random(edit.new_faces.size() * 0x9e3779b97f4a7c15ull + edit.new_vertices.size());
  for (int tries = 0; tries < 32; ++tries) {
    // The points that the fault's faces have and that rounding has moved anyway, a little farther each time.
    const double distance = last_place * std::pow(2.0, tries / 2);
    std::vector<std::pair<std::uint32_t, Vec3>> before;
    for (const auto f : fault.faces)
      for (const VertexId v : edit.new_faces[f].v) {
        if (v.value < complex.vertex_count() || !moved[v.value - complex.vertex_count()]) continue;
        const std::uint32_t i = v.value - complex.vertex_count();
        before.push_back({i, edit.new_vertices[i]});
        edit.new_vertices[i] += distance * random.uniform(0.5, 1.0) * random.direction();
      }
    if (before.empty()) return fault;
    Fault now = find_fault(complex, edit, families, moved);
    if (!now) {
      ++repairs;
      return now;
    }
    if (now.faces == fault.faces)
      for (auto b = before.rbegin(); b != before.rend(); ++b) edit.new_vertices[b->first] = b->second;
    else
      fault = std::move(now);  // that one is mended; this comes next
  }
  return fault;
}

}  // namespace geo
