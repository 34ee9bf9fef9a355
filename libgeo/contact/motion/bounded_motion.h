// Moves a surface to where it should be, or as near to it as it comes without crossing itself.
#pragma once

#include "contact/detection/broad_phase.h"
#include "contact/detection/surface_motion.h"
#include "contact/detection/vertex_fans.h"

namespace geo {

struct BoundedMotionStats {
  std::size_t planes = 0;    ///< between parts that might have met
  std::size_t in_zones = 0;  ///< vertices that had to move as rigid zones
  bool held = false;         ///< nothing could be carried along
};

/// The end of the motion, by row; rows together move together. At the beginning no triangles cross,
/// and at the end none do. After the affine motion that is closest to what they want, all go
/// straight to their places. Where pairs of triangles would cross, by the exact test of crossing.h,
/// or pass, the places (or the guess) are mended first, again and again; the few that no mending
/// parts move as rigid zones meanwhile (give_way.h). If something fails after many rounds all the
/// same, vertices of such pairs are carried along by a smooth field of what all want
/// (smooth_field.h), in which neither side of a narrow gap passes the other; what crosses all the
/// same, since triangles are flat and the field is not, moves as rigid zones (Provot 1997; Bridson,
/// Fedkiw, Anderson 2002), which grow until nothing does. From there, then, each vertex for itself
/// goes straight on where nothing is in its way, and as far as planes between near parts let it
/// (settle.h). `near`: what is known of the same triangles from watch(), about this motion or one
/// like it; `fans`: of them.
std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided,
                                        BoundedMotionStats* report = nullptr, BroadPhase* near = nullptr,
                                        const VertexFans* fans = nullptr);

}  // namespace geo
