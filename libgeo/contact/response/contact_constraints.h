// From pairs that might meet to constraints on what touches.
#pragma once

#include "contact/detection/watch.h"
#include "contact/response/impulses.h"
#include "contact/surface/contact_surface.h"

namespace geo {

/// How constraints come out: on velocities, as the speed at which the two may still approach; on displacements, as the
/// share of what they lack at the end of the motion that they must part by in a time step.
struct ConstraintOptions {
  double dt;
  double share = 0;  ///< 0: on velocities
  double reach = 0;  ///< model units: what the motion brings nearer to its gap than that counts, too
};

/// The closest places of each watched pair that the motion would bring nearer than its gap, each couple of places once;
/// the same in whatever order pairs are watched.
std::vector<ContactConstraint> contact_constraints(const std::vector<Watched>& watched, const SurfaceMotion& motion,
                                                   const ConstraintOptions& how);

/// Copies that are together and that their own targets would push through each other: the two sides of a sheet, parted
/// by the difference of their normals.
void add_sheet_constraints(const Copies& copies, const std::vector<Vec3>& targets, const std::vector<Vec3>& normals,
                           double tolerance, const ConstraintOptions& how, std::vector<ContactConstraint>& out);

/// Of those between the same two neighbourhoods of nodes, the deepest `most`: more say the same, for nodes are farther
/// apart than vertices. In the order given.
std::vector<ContactConstraint> deepest_constraints(const std::vector<ContactConstraint>& touching,
                                                   const SurfaceWeights& weights, std::size_t most);

}  // namespace geo
