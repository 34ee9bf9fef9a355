// The inverse of the deformation: from world positions back into the undeformed material (§ 3.2).
#pragma once

#include <limits>
#include <unordered_map>

#include "kerf/body.h"
#include "mechanics/discretisation/nodal_gradients.h"
#include "sampling/node_grid.h"

namespace geo {

/// Inverts Eq. 1 by Broyden's method. Only nodes that are near the point both in the
/// material and in the world take part: fully up to 1.5 support radii in the world, fading to none
/// at 3. Hence material that is close in the world but far in the material, such as the two sides
/// of an open cut, is not mixed. The initial guess blends the nodes' own affine maps with kernel
/// weights in the world. Near the skin the map fades into the one that is linear on each deformed
/// triangle, which is exact there. The map is continuous except where the material is torn. Threads
/// may query the same object at the same time, each with a cache of its own.
class InverseDeformation {
 public:
  /// For points inside the box `about`, world coordinates. `u` and `gradient` are per node. All
  /// arguments must outlive the object. `included`: per node, 0 if its material is not mapped;
  /// empty: all nodes.
  InverseDeformation(const Body& body, const std::vector<Vec3>& u, const LazyNodalGradients& gradient,
                     const Box3& about, std::vector<std::uint8_t> included = {});

  /// The result of a query.
  struct Location {
    Vec3 position;            ///< in the material
    NodeId nearest;           ///< the nearest node in the world; invalid: none is near
    bool in_support = false;  ///< inside its support; otherwise `position` follows its translation only
  };
  /// Deformed positions of surface vertices that queries near each other share.
  using VertexCache = std::unordered_map<std::uint32_t, Vec3>;
  /// The material location of a world position. Results do not depend on the cache. Where the map
  /// is not one to one, `before` chooses: a place in the material, or null. If the support of a
  /// node within four spacings of it holds the position, such nodes alone are the nearest.
  Location to_material(const Vec3& world, VertexCache& cache, const Vec3* before = nullptr) const;
  /// The same without a cache.
  Location to_material(const Vec3& world) const {
    VertexCache none;
    return to_material(world, none);
  }
  /// The place to which the affine map of one node takes a world position, however far it is.
  Vec3 to_material_of(NodeId node, const Vec3& world) const;

 private:
  /// The nodes that take part at a world position; valid within half of the largest support of
  /// `material`.
  struct Neighborhood {
    Vec3 world, material = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    std::vector<std::uint32_t> node;
    std::vector<double> fading;  // factor of the node's weight, by its distance in the world
  };
  NodeId nearest_node(const Vec3& y, const Vec3* before) const;
  void update(Neighborhood& near, const Vec3& x) const;
  bool is_included(std::size_t node) const { return included_.empty() || included_[node]; }
  bool is_included(FaceId f) const;
  /// Eq. 1 at x as `to`, and F = I + Σ w_i ∇u_i / Σ w_i, its derivative less that of the weights;
  /// false if no node reaches x.
  bool deform(Neighborhood& near, const Vec3& x, Vec3& to, Mat3& f) const;
  Vec3 solve(Neighborhood& near, Vec3 x, double tolerance) const;
  Vec3 skin_correction(Neighborhood& near, const Vec3& x, double range, VertexCache& cache) const;
  Vec3 deformed_vertex(SurfaceVertexId v, VertexCache& cache) const;

  const Body& body_;
  const std::vector<Vec3>& u_;
  const LazyNodalGradients& gradient_;
  std::vector<std::uint8_t> included_;
  double largest_support_;
  std::vector<Vec3> world_;  // per node
  NodeGrid grid_;            // of the nodes near `about`, in the world
};

}  // namespace geo
