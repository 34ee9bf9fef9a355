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

/// A point whose shape gradients are to be computed. In: its position, and as `influence_radius`
/// the distance from its intended position.
struct SupportTask {
  MaterialPoint* point;
  ShapeGradients* shape;
};
/// Computes the shape gradients, and all members of the points except volumes. Consecutive tasks
/// should be near each other. `occluders`: those of the whole surface; null: nearby ones are
/// queried.
void compute_supports(const Body& body, std::vector<SupportTask> tasks, const Occluders* occluders = nullptr);

}  // namespace geo
