// The distance field that a rigid thing carries in its own space (§ 3.3, between objects): of a
// plane, or of a closed mesh.
//
// The distance is that to the triangles themselves, not sampled: at corners a grid rounds what is
// sharp, parts thinner than its cells lose their inside, and its gradient is not that of its
// values, which a line search would notice. A query costs the logarithm of the triangles.
#pragma once

#include <array>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

class RigidShape {
 public:
  /// The half space behind the plane through the origin; the normal, of any length, points out of
  /// it.
  static RigidShape half_space(const Vec3& normal);
  /// The inside of a mesh that is closed, manifold and oriented outwards (require_solid).
  explicit RigidShape(const TriangleMesh& mesh);

  struct Field {
    double distance = 0;         ///< negative inside
    Vec3 normal = Vec3::Zero();  ///< the distance's gradient; on the surface that of the angle-weighted normals
    Mat3 square = Mat3::Zero();  ///< second derivative of half the squared distance, exact: of rank 1, 2 or 3 where the
                                 // /< nearest is a face, an edge, a corner
  };
  /// Inside or outside is told by the angle-weighted normal of the nearest face, edge or corner,
  /// which is exact but for rounding (Bærentzen and Aanæs 2005).
  Field at(const Vec3& x) const;
  /// False: x is farther than `reach` outside.
  bool near(const Vec3& x, double reach) const;
  /// From the origin to the farthest point; 0 of a half space.
  double extent() const { return extent_; }

 private:
  RigidShape() = default;
  Vec3 plane_ = Vec3::Zero();  // its normal; zero: a mesh
  TriangleBvh bvh_;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<std::array<Vec3, 7>> normals_;  // of each triangle: by ClosestOnTriangle::feature + 1
  double extent_ = 0;
};

}  // namespace geo
