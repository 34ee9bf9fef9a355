// Sign by pseudonormals (Bærentzen and Aanæs 2005): Σ angle · n at vertices, Σ n at edges. Hessian
// of ½ d²: n nᵀ at a face, I − t tᵀ at an edge with direction t, I at a vertex.
#include "contact/response/rigid_shape.h"

#include <cmath>
#include <map>

#include "base/elementary.h"
#include "geometry/distance.h"

namespace geo {

RigidShape RigidShape::half_space(const Vec3& normal) {
  RigidShape shape;
  shape.plane_ = normal.normalized();
  return shape;
}

RigidShape::RigidShape(const TriangleMesh& mesh) : corners_(corners_of(mesh)) {
  bvh_ = TriangleBvh(corners_);
  normals_.resize(corners_.size());
  std::vector<Vec3> corner(mesh.vertices.size(), Vec3::Zero());
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> edge;
  const auto key = [](std::uint32_t a, std::uint32_t b) { return std::pair{std::min(a, b), std::max(a, b)}; };
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    const auto& [a, b, c] = corners_[t];
    const Vec3 n = (b - a).cross(c - a).normalized();
    normals_[t][0] = n;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = corners_[t][k], to = corners_[t][(k + 1) % 3] - p, from = corners_[t][(k + 2) % 3] - p;
      corner[mesh.triangles[t][k]] += angle_of(to.cross(from).norm(), to.dot(from)) * n;
      edge.try_emplace(key(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), Vec3::Zero()).first->second += n;
      extent_ = std::max(extent_, p.norm());
    }
  }
  for (std::size_t t = 0; t < corners_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      normals_[t][1 + k] = corner[mesh.triangles[t][k]].normalized();
      normals_[t][4 + k] = edge.at(key(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])).normalized();
    }
}

bool RigidShape::near(const Vec3& x, double reach) const {
  if (corners_.empty()) return plane_.dot(x) <= reach;
  return bvh_.box().grown(reach).meets({x, x});
}

RigidShape::Field RigidShape::at(const Vec3& x) const {
  if (corners_.empty()) return {plane_.dot(x), plane_, plane_ * plane_.transpose()};
  const std::size_t row = bvh_.closest(x).triangle;
  const auto& t = corners_[row];
  const ClosestOnTriangle on = closest_on_triangle(x, t[0], t[1], t[2]);
  const Vec3 away = x - on.point;
  const Vec3& outwards = normals_[row][static_cast<std::size_t>(on.feature + 1)];
  const double side = away.dot(outwards) < 0 ? -1 : 1, distance = away.norm();
  Field field{side * distance, distance > 0 ? Vec3(side / distance * away) : outwards, Mat3::Identity()};
  if (on.feature < 0) {
    field.normal = outwards;
    field.half_square_hessian = outwards * outwards.transpose();
  } else if (on.feature >= 3) {
    const auto k = static_cast<std::size_t>(on.feature - 3);
    const Vec3 along = (t[(k + 1) % 3] - t[k]).normalized();
    field.half_square_hessian -= along * along.transpose();
  }
  return field;
}

}  // namespace geo
