// Collision-free motion of a surface: towards wanted positions, as far as it does not cross itself.
#pragma once

#include <vector>

#include "contact/detection/broad_phase.h"
#include "contact/detection/surface_motion.h"
#include "contact/detection/vertex_fans.h"

namespace geo {

/// Statistics of one motion.
struct BoundedMotionStats {
  std::size_t planes = 0;       ///< separating planes between triangles that might have met
  std::size_t in_zones = 0;     ///< vertices that moved in rigid impact zones, at most at a time
  std::size_t evaluations = 0;  ///< of separation constraints, in all sweeps of all projections
  bool held = false;            ///< not even a rigid motion was possible, so nothing moved
};

/// Positions at the end of the motion, per vertex; coincident vertices stay coincident. No
/// triangles cross at the beginning, and none at the end, by the exact test (find_crossings.h);
/// none has passed through another.
///
/// 1. The affine motion nearest to the wanted one is applied. Then all vertices go straight to
///    their targets, or to `motion.guess` if there is one. From a guess, vertices with nothing in
///    the way go on to their targets (vertex_advance.h).
/// 2. Where this is not certified (motion_certifier.h), targets are changed by projection of
///    separation constraints (separation_projection.h).
/// 3. If that fails, vertices of uncertified pairs follow a smooth field of the wanted motion, or
///    rigid impact zones (fallback_motion.h). Both grow until all pairs are certified. The tracking
///    error that this leaves is reduced (vertex_advance.h). If the field was scaled down, the
///    motion begins again from there.
///
/// The effort is bounded. If a motion takes triangles far past each other, a round has a share of
/// it (BroadPhase::update_for_share()); there are eight rounds. Projections evaluate 1,000
/// constraints per triangle and then finish their sweep; no round follows.
///
/// `near`: pairs known of the same triangles, from find_contact_candidates() or an earlier motion
/// in this step; `fans`: of the triangles; null: made here. `two_sided`: as in find_crossings().
std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided,
                                        BoundedMotionStats* stats = nullptr, BroadPhase* near = nullptr,
                                        const VertexFans* fans = nullptr);

}  // namespace geo
