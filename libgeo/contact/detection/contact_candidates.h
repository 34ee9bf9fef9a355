// Contact candidates: pairs of triangles that a step may bring together, each with an axis that
// separates them at the start.
//
// If one axis separates two convex sets at both ends of a straight motion, they do not meet during
// it (candidate_axes.h). Triangles that share vertices are not candidates.
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
  /// Vertices are representatives; the two share none.
  Simplex a, b;
  /// Chosen separating axis, unit, from b to a. Its direction may differ from closest.difference.
  Vec3 normal;
  /// Closest points at the start of the motion.
  ClosestPoints closest;
  /// min(motion.gap, start separation along `normal`), which the step should leave; model units.
  double gap;
};

/// Limits the candidates between two nodes. Nodes are farther apart than vertices, so that more
/// constraints on the same two nodes would be redundant.
struct CandidateLimit {
  /// Per surface vertex the node that owns it, ~0u if none; empty: no limit.
  std::span<const std::uint32_t> owner = {};
  std::size_t most = 0;  ///< candidates for each pair of owners, at least 1
};

/// The candidates of a motion: pairs of triangles with start distance > 0 and no shared vertex. A
/// pair is culled if one axis has start separation ≥ motion.gap and end separation ≥ motion.reach.
/// The set depends on the motion alone; its order depends on the history of `broad_phase`, too.
/// With a limit, each two owners keep their limit.most pairs of least
/// TrianglePlanes::end_separations(). If a motion has too many pairs of boxes, only those of a
/// share are considered (BroadPhase::update_for_share()), from the affine motion on. The whole
/// motion decides about them. Updates `broad_phase`, whose boxes are relative to the affine motion
/// that fits the surface best.
std::vector<ContactCandidate> find_contact_candidates(const SurfaceMotion& motion, BroadPhase& broad_phase,
                                                      const CandidateLimit& limit = {});

}  // namespace geo
