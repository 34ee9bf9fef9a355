// From the world back to the material (§ 3.2).
#pragma once

#include <limits>
#include <unordered_map>

#include "kerf/body.h"
#include "mechanics/discretisation/nodal_gradients.h"
#include "sampling/node_grid.h"

namespace geo {

/// Maps points about a deformed body back into it. Eq. 1 is solved for x by Newton's method, where
/// nodes count that are near both in the material and, as far as 1.5 support radii and less and
/// less up to 3, in the world: what lies close in the world, but apart in the material, is not
/// mixed, and neither are the two sides of a wide open cut. The first guess blends the nodes' own
/// affine maps with weights in world coordinates. Near the skin the map goes over into the one that
/// is linear on each deformed triangle, which is exact there. Continuous but where the material is
/// torn. Several threads may ask at once, each with its own memory.
class PointMap {
 public:
  /// For points in `about`, world coordinates. `u`, `gradient`: per node. All must outlive the map.
  /// `counted`: per node, 0 where it belongs to what is not mapped; empty: all count.
  PointMap(const Body& body, const std::vector<Vec3>& u, const LazyNodalGradients& gradient, const Box3& about,
           std::vector<std::uint8_t> counted = {});

  struct Place {
    Vec3 material;
    NodeId anchor;        ///< invalid: no node is near
    bool within = false;  ///< of the anchor's support; else only the anchor's translation is meant
  };
  /// Deformed surface vertices that points near each other have in common: kept from one point to
  /// the next.
  using Memory = std::unordered_map<std::uint32_t, Vec3>;
  Place material(const Vec3& world, Memory& memory) const;
  Place material(const Vec3& world) const {
    Memory none;
    return material(world, none);
  }

 private:
  /// The nodes that may count at a point of the world, half their supports about where they were
  /// looked for in the material.
  struct Round {
    Vec3 world, material = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    std::vector<std::uint32_t> node;
    std::vector<double> share;  // of their weight, by how near they are in the world
  };
  void look(Round& round, const Vec3& x) const;
  bool counts(std::size_t node) const { return counted_.empty() || counted_[node]; }
  bool counts(FaceId f) const;
  /// Where Eq. 1 puts x, its slope there; false where no node counts.
  bool forward(Round& round, const Vec3& x, Vec3& to, Mat3& slope) const;
  Vec3 solve(Round& round, Vec3 x, double enough) const;
  Vec3 on_skin(Round& round, const Vec3& x, double reach, Memory& memory) const;
  Vec3 deformed(SurfaceVertexId v, Memory& memory) const;

  const Body& body_;
  const std::vector<Vec3>& u_;
  const LazyNodalGradients& gradient_;
  std::vector<std::uint8_t> counted_;
  double reach_;             // the largest support radius
  std::vector<Vec3> world_;  // per node
  NodeGrid grid_;            // of those near `about`
};

}  // namespace geo
