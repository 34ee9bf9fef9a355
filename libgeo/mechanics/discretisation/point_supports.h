// Supports of material points: the nodes whose support holds a point and which it sees, straight
// ahead or round the front of a crack. Supports are widened until a point sees enough nodes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "mechanics/discretisation/diffraction.h"
#include "mechanics/discretisation/material_points.h"

namespace geo {

/// Factors of the support radii, powers of 1.2, that are tried in turn while a point sees too few
/// nodes.
constexpr std::array support_factors{1.0, 1.2, 1.44, 1.728, 2.0736};

/// Faces that may hide nodes from points, and the crack fronts that a line of sight may bend round.
struct Occluders {
  /// None.
  Occluders() = default;
  /// The faces `ids` of the surface and their front edges.
  Occluders(const Complex& surface, std::span<const FaceId> ids);
  TriangleBvh faces;
  std::vector<FrontEdge> fronts;
};
/// All faces of a surface that are alive.
Occluders all_occluders(const Complex& surface);

/// The position of a point that is intended at p. A point on a face belongs to neither side, so it
/// is moved towards the nearest node by a small fraction of the distance.
Vec3 moved_off_faces(const Body& body, const Vec3& p);

/// Possible changes of visibility since a set of points was computed.
struct VisibilityChanges {
  TriangleBvh faces;               ///< added or removed since
  std::vector<std::uint8_t> node;  ///< per node: 1 if it is new, has moved, or has another support radius
};

/// A point whose shape gradients are to be computed. In: its position, and as `influence_radius`
/// the distance from its intended position. `before`: the block where it was point number
/// `point_before`, or null.
struct SupportTask {
  MaterialPoint* point;
  ShapeGradients* shape;
  const PointBlock* before = nullptr;
  std::size_t point_before = 0;
};
/// Computes the shape gradients, and all members of the points except volumes. Consecutive tasks
/// should be near each other. `occluders`: those of the whole surface; null: nearby ones are
/// queried. `changes`: since the blocks `before` of the tasks; lines of sight that they do not
/// touch are not tested again, with the same result. Null: all are tested.
void compute_supports(const Body& body, std::vector<SupportTask> tasks, const Occluders* occluders = nullptr,
                      const VisibilityChanges* changes = nullptr);

}  // namespace geo
