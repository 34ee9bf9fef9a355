// Contact constraints of a time step: the pairs of surface points that its motion brings too near
// each other.
#pragma once

#include "contact/detection/contact_candidates.h"
#include "contact/response/relative_stencil.h"
#include "contact/surface/contact_surface.h"

namespace geo {

/// Two surface points that must not come nearer to each other along a normal.
struct ContactConstraint {
  SurfacePoint a, b;
  Vec3 normal;       ///< unit, from b to a
  double depth = 0;  ///< gap − separation along the normal at the end of the motion, model units
  /// Relative speed along −normal that is still allowed, model units per second; negative: they
  /// must separate.
  double approach = 0;
};

/// How constraints are stated.
struct ConstraintOptions {
  double dt;  ///< s
  /// 0: on velocities, which may close the distance down to the gap. Otherwise on displacements:
  /// the points must recover this share of their depth in a step.
  double share = 0;
  double reach = 0;  ///< points that the motion brings nearer than gap + reach are included, model units
};

/// Constraints kept between two nodes' neighbourhoods: three points hold a plane off another, and
/// one more is for a pair that is not flat.
constexpr std::size_t constraints_per_node_pair = 4;

/// A constraint for the closest points of each candidate pair that the motion brings nearer than
/// its gap (and reach). Points that several pairs share are constrained once. The result does not
/// depend on the order of candidates.
std::vector<ContactConstraint> contact_constraints(const std::vector<ContactCandidate>& candidates,
                                                   const SurfaceMotion& motion, const ConstraintOptions& options);

/// Adds constraints between coincident vertices, the sides of a closed sheet, whose targets lie
/// farther than `tolerance` behind each other. The normal is the difference of the vertices'
/// normals (`normals`: normals_across_sheets()). ConstraintOptions::reach has no effect.
void add_sheet_constraints(const CoincidentVertices& coincident, const std::vector<Vec3>& targets,
                           const std::vector<Vec3>& normals, double tolerance, const ConstraintOptions& options,
                           std::vector<ContactConstraint>& constraints);

/// Assigns each constraint to the heaviest nodes of its two points, and keeps the `count` deepest
/// for every two nodes. More would be redundant, since nodes are farther apart than vertices. Keeps
/// the order.
std::vector<ContactConstraint> deepest_constraints(const std::vector<ContactConstraint>& constraints,
                                                   const SurfaceWeights& weights, std::size_t count);

}  // namespace geo
