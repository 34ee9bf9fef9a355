// Signed distance field of a rigid body in its own coordinates: a half space or a closed mesh
// (§ 3.3, contact with rigid objects).
//
// Distances are exact, to the triangles, instead of sampled on a grid. A grid would round sharp
// corners and lose thin parts. Its gradient would differ from that of its values, and a line search
// would notice. A query costs the logarithm of the number of triangles.
#pragma once

#include <array>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

/// The shape of a rigid obstacle.
class RigidShape {
 public:
  /// The half space behind the plane through the origin. `normal`: of any length, out of it.
  static RigidShape half_space(const Vec3& normal);
  /// The inside of a mesh that is closed, manifold and oriented outwards (require_solid()).
  explicit RigidShape(const TriangleMesh& mesh);

  /// The field at a point.
  struct Field {
    double distance = 0;         ///< negative inside
    Vec3 normal = Vec3::Zero();  ///< gradient of the distance; on the surface the angle-weighted normal
    /// Second derivative of half the squared distance, exact: of rank 1, 2 or 3 where the nearest
    /// feature is a face, an edge or a vertex.
    Mat3 half_square_hessian = Mat3::Zero();
  };
  /// The field at x. The sign follows from the angle-weighted normal of the nearest face, edge or
  /// vertex, which is exact but for rounding (Bærentzen and Aanæs 2005).
  Field at(const Vec3& x) const;
  /// False only if x is farther than `reach` outside.
  bool near(const Vec3& x, double reach) const;
  /// Largest distance of a point of the shape from the origin; 0 for a half space.
  double extent() const { return extent_; }

 private:
  RigidShape() = default;
  Vec3 plane_ = Vec3::Zero();  // normal of the half space; zero for a mesh
  TriangleBvh bvh_;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<std::array<Vec3, 7>> normals_;  // per triangle, by index of the nearest feature + 1
  double extent_ = 0;
};

}  // namespace geo
