// The shortest ways round the fronts of cracks, by which a point takes nodes that a crack hides from it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/complex.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

/// An edge ab of a crack's front: material is all round it but for one face. `ahead`, a unit vector, leads on from that
/// face.
struct FrontEdge {
  Vec3 a, b, ahead;
};

/// The front edges of some crack faces, in the order of faces and their corners.
std::vector<FrontEdge> front_edges(const Complex& complex, std::span<const FaceId> faces);

/// A node as x sees it round one of the edges, where `faces` hide it: by the diffraction criterion (Organ, Fleming,
/// Terry and Belytschko 1996), (L / s)⁴ s away, s the straight distance and L the shortest way's length. (At powers of
/// 1 and 2, as theirs, nodes weld a crack behind its front where supports are as short as 1.8 spacings:
/// docs/validation.md.) None: that is `reach` or more, or there is no way. A way bends a 1024th of `reach` ahead of an
/// edge, and both its parts are clear of faces (exact); so none leads past a crack that has cut through, which has no
/// front. `edges`: all that are within `reach` of x.
std::optional<Sight> sight_round(const Vec3& x, const Vec3& node, double reach, std::span<const FrontEdge> edges,
                                 const TriangleBvh& faces);

}  // namespace geo
