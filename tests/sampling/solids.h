// Models for tests of sampling: some smooth, some with flat faces along the axes, some thin.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kerf/mesh.h"

namespace solids {

/// `outside` with a void of the shape `inside`.
inline geo::TriangleMesh hollow(geo::TriangleMesh outside, const geo::TriangleMesh& inside) {
  const auto first = static_cast<std::uint32_t>(outside.vertices.size());
  outside.vertices.insert(outside.vertices.end(), inside.vertices.begin(), inside.vertices.end());
  for (const auto& [a, b, c] : inside.triangles) outside.triangles.push_back({first + a, first + c, first + b});
  return outside;
}

inline geo::TriangleMesh moved(geo::TriangleMesh mesh, const geo::Vec3& by) {
  for (auto& p : mesh.vertices) p += by;
  return mesh;
}

/// About a skew axis, so that nothing is along a coordinate axis.
inline geo::TriangleMesh turned(geo::TriangleMesh mesh) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, geo::Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& p : mesh.vertices) p = turn * p;
  return mesh;
}

/// The skin of a ball of radius 1, as thick as given.
inline geo::TriangleMesh shell(double thickness) {
  return hollow(geo::make_sphere(16), geo::make_star(16, [&](const geo::Vec3&) { return 1 - thickness; }));
}

inline std::vector<std::pair<std::string, geo::TriangleMesh>> all() {
  return {{"pumpkin", geo::make_pumpkin(8)},
          {"apple", geo::make_apple(8)},
          {"polyp", geo::make_polyp(8)},
          {"block", geo::make_block({2, 1, 1}, 0.5)},
          {"letter", geo::make_letter('K', 0.25, 12)},
          {"turned block", turned(geo::make_block({2, 1, 1}, 0.5))},
          {"shell", shell(0.1)}};
}

}  // namespace solids
