#include "crack/guard.h"

#include <algorithm>
#include <numeric>

#include "geometry/predicates.h"
#include "surface/check.h"

namespace geo {

std::string find_fault(const Complex& complex, const ComplexEdit& edit, std::span<const Family> families) {
  const auto point = [&](VertexId v) -> const Vec3& {
    return v.value < complex.vertex_count() ? complex.point(v) : edit.new_vertices[v.value - complex.vertex_count()];
  };
  const auto n = static_cast<std::uint32_t>(edit.new_faces.size());
  std::vector<std::array<Vec3, 3>> corners(n);
  std::vector<std::array<std::uint32_t, 3>> rows(n);
  std::vector<Box3> boxes(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) corners[i][k] = point(edit.new_faces[i].v[k]), rows[i][k] = edit.new_faces[i].v[k].value;
    boxes[i] = box_of(corners[i][0], corners[i][1], corners[i][2]);
  }
  for (const Family& family : families) {
    const auto& p = family.plane;
    int axis = 0;
    (p[1] - p[0]).cross(p[2] - p[0]).cwiseAbs().maxCoeff(&axis);
    const int was = orient2d(p[0], p[1], p[2], axis);
    for (auto i = family.first; i < family.end; ++i) {
      const int is = orient2d(corners[i][0], corners[i][1], corners[i][2], axis);
      if (is == 0) return "rounding would leave a face without area";
      if (was != is) return "rounding would turn a face over";
    }
  }

  // Vertices at one place: new ones among each other and against the corners of what is there.
  const auto less = [](const Vec3& a, const Vec3& b) { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); };
  std::vector<VertexId> vertices;
  for (const auto& f : edit.new_faces) vertices.insert(vertices.end(), f.v.begin(), f.v.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::sort(vertices.begin(), vertices.end(), [&](VertexId a, VertexId b) { return less(point(a), point(b)); });
  for (std::size_t i = 1; i < vertices.size(); ++i)
    if (point(vertices[i - 1]) == point(vertices[i])) return "rounding would put two vertices at one place";

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
    for (auto i = family.first; i < family.end; ++i) box.add(boxes[i]);
    near.clear();
    looked_up.clear();
    if (family.near.empty()) complex.near(box, looked_up);
    for (const FaceId f : family.near.empty() ? std::span<const FaceId>(looked_up) : family.near) {
      const Box3 there = complex.box(f);
      if (there.meets(box) && !std::binary_search(removed.begin(), removed.end(), f)) near.push_back({f, there});
    }
    for (auto i = family.first; i < family.end; ++i)
      for (const Near& other : near) {
        if (!other.box.meets(boxes[i])) continue;
        const auto& v = complex.face(other.face).v;
        if (faces_cross(rows[i], corners[i], {v[0].value, v[1].value, v[2].value}, complex.corners(other.face)))
          return "rounding would make a new face cross face " + std::to_string(other.face.value);
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
      if (boxes[a].meets(boxes[b]) && faces_cross(rows[a], corners[a], rows[b], corners[b])) return "rounding would make two new faces cross";
    }
  return {};
}

}  // namespace geo
