#include "crack/guard.h"

#include <algorithm>
#include <map>

#include "geometry/predicates.h"
#include "surface/check.h"

namespace geo {
namespace {

// The sign of a planar triangle seen along an axis, exactly: orient3d against a point far along that axis.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  Vec3 d = a;
  const double size = (b - a).cwiseAbs().maxCoeff() + (c - a).cwiseAbs().maxCoeff() + std::abs(a[axis]);
  // Any point off the plane of the projection would do: the three corners are flattened first.
  Vec3 fa = a, fb = b, fc = c;
  fa[axis] = fb[axis] = fc[axis] = 0;
  d = fa;
  d[axis] = size > 0 ? size : 1;
  return orient3d(fa, fb, fc, d);
}

}  // namespace

std::string find_fault(const Complex& complex, const ComplexEdit& edit, const std::vector<std::array<Vec3, 3>>& planes) {
  const auto point = [&](VertexId v) -> const Vec3& {
    return v.value < complex.vertex_count() ? complex.point(v) : edit.new_vertices[v.value - complex.vertex_count()];
  };
  const std::size_t n = edit.new_faces.size();
  std::vector<std::array<Vec3, 3>> corners(n);
  std::vector<std::array<std::uint32_t, 3>> rows(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) corners[i][k] = point(edit.new_faces[i].v[k]), rows[i][k] = edit.new_faces[i].v[k].value;
    sum += (corners[i][1] - corners[i][0]).norm();
    const auto& p = planes[i];
    int axis = 0;
    (p[1] - p[0]).cross(p[2] - p[0]).cwiseAbs().maxCoeff(&axis);
    const int was = turn(p[0], p[1], p[2], axis), is = turn(corners[i][0], corners[i][1], corners[i][2], axis);
    if (is == 0) return "rounding would leave a face without area";
    if (was != is) return "rounding would turn a face over";
  }
  const auto less = [](const Vec3& a, const Vec3& b) { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); };
  std::map<Vec3, VertexId, decltype(less)> places(less);
  for (const auto& f : edit.new_faces)
    for (const VertexId v : f.v) {
      const auto [it, fresh] = places.try_emplace(point(v), v);
      if (it->second != v) return "rounding would put two vertices at one place";
    }

  std::vector<FaceId> removed = edit.removed_faces;
  std::sort(removed.begin(), removed.end());
  TriangleIndex fresh_faces(n > 0 ? std::max(sum / double(n), complex.extent().diagonal() * 1e-6) : 1.0);
  std::vector<FaceId> near;
  std::vector<std::uint32_t> others;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Box3 box = box_of(corners[i][0], corners[i][1], corners[i][2]);
    near.clear();
    complex.near(box, near);
    for (const FaceId f : near) {
      if (std::binary_search(removed.begin(), removed.end(), f)) continue;
      const auto& v = complex.face(f).v;
      if (faces_cross(rows[i], corners[i], {v[0].value, v[1].value, v[2].value}, complex.corners(f)))
        return "rounding would make a new face cross face " + std::to_string(f.value);
    }
    others.clear();
    fresh_faces.find(box, others);
    for (const auto j : others)
      if (faces_cross(rows[i], corners[i], rows[j], corners[j])) return "rounding would make two new faces cross";
    fresh_faces.insert(i, box);
  }
  return {};
}

}  // namespace geo
