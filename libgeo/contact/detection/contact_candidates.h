// Contact candidates: pairs of triangles that a step may bring together, each with an axis that
// separates them at the start.
//
// If one axis separates two convex sets at both ends of a straight motion, they do not meet during
// it (separating_axes.h). Triangles that share vertices are not candidates.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contact/detection/broad_phase.h"
#include "contact/detection/simplex.h"
#include "contact/detection/surface_motion.h"

namespace geo {

/// A pair of triangles that may come together.
struct ContactCandidate {
  Simplex a, b;           ///< of representatives, none in both
  Vec3 normal;            ///< separating axis, unit, from b to a
  ClosestPoints closest;  ///< at the start
  double gap;             ///< least separation along the normal that the step should leave, model units
};

/// Limits the candidates between two nodes: more say the same, since nodes are farther apart than
/// vertices.
struct CandidateLimit {
  std::span<const std::uint32_t> owner = {};  ///< per surface vertex: its node; empty: no limit
  std::size_t most = 0;                       ///< candidates for each pair of owners, at least 1
};

/// The candidates of a motion: pairs without a common vertex that no axis keeps at a distance of
/// motion.reach or more. The set depends on the motion alone; its order depends on the history of
/// `broad_phase`, too. With a limit, pairs between the same two owners are chosen by
/// TrianglePlanes::end_separations(): those that the motion brings closest. Updates `broad_phase`,
/// whose boxes are relative to the affine motion that fits the surface best.
std::vector<ContactCandidate> find_contact_candidates(const SurfaceMotion& motion, BroadPhase& broad_phase,
                                                      const CandidateLimit& limit = {});

}  // namespace geo
