// From the world back to the material (§ 3.2).
#pragma once

#include <limits>
#include <unordered_map>

#include "body/body.h"
#include "mechanics/node_rows.h"
#include "sampling/node_grid.h"

namespace geo {

/// Maps points about a deformed body back into it. Eq. 1 is solved for x by Newton's method, where nodes count that are near
/// both in the material and, as far as 1.5 support radii and less and less up to 3, in the world: what lies close in the
/// world, but apart in the material, is not mixed, and neither are the two sides of a wide open cut. The first guess blends
/// the nodes' own affine maps with weights in world coordinates. Near the skin the map goes over into the one that is linear
/// on each deformed triangle, which is exact there. Continuous but where the material is torn. Not
/// to be asked by several threads at once.
class PointMap {
 public:
  /// For points in `about`, world coordinates. `u`, `gradient`: per node. All must outlive the map. `counted`: per node, 0 where it
  /// belongs to what is not mapped; empty: all count.
  PointMap(const Body& body, const std::vector<Vec3>& u, const NodeGradients& gradient, const Box3& about, std::vector<std::uint8_t> counted = {});

  struct Place {
    Vec3 material;
    NodeId anchor;       ///< invalid: no node is near
    bool within = false; ///< of the anchor's support; else only the anchor's translation is meant
  };
  Place material(const Vec3& world) const;

 private:
  void look_round(const Vec3& world, const Vec3& x) const;
  bool counts(std::size_t node) const { return counted_.empty() || counted_[node]; }
  bool counts(FaceId f) const;
  /// Where Eq. 1 puts x, its slope there; false where no node counts.
  bool forward(const Vec3& world, const Vec3& x, Vec3& to, Mat3& slope) const;
  Vec3 solve(const Vec3& world, Vec3 x, double enough) const;
  Vec3 on_skin(const Vec3& world, const Vec3& x, double reach) const;
  Vec3 deformed(SurfaceVertexId v) const;

  const Body& body_;
  const std::vector<Vec3>& u_;
  const NodeGradients& gradient_;
  std::vector<std::uint8_t> counted_;
  double reach_;             // the largest support radius
  std::vector<Vec3> world_;  // per node
  NodeGrid grid_;            // of those near `about`
  mutable std::unordered_map<std::uint32_t, Vec3> deformed_;  // surface vertices asked for
  struct Round {
    Vec3 world = Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), material;
    std::vector<std::uint32_t> node;
    std::vector<double> share;  // of their weight, by how near they are in the world
  };
  mutable Round round_;  // looked at last
};

}  // namespace geo
