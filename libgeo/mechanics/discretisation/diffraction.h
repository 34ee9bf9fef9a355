// Visibility round the fronts of cracks: the diffraction criterion for meshless shape functions
// (Organ, Fleming, Terry and Belytschko 1996).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "mechanics/discretisation/occluding_faces.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

/// An edge ab of a crack's front: material surrounds it except for one crack face. `ahead`: unit
/// vector in the plane of that face, normal to the edge, away from the face.
struct FrontEdge {
  Vec3 a, b, ahead;
};

/// The front edges of the crack faces among `faces`, in the order of faces and their corners.
std::vector<FrontEdge> front_edges(const Complex& complex, std::span<const FaceId> faces);

/// Faces that may hide nodes from points, and the crack fronts that a line of sight may bend round.
struct Occluders {
  /// Makes these the faces `ids` of the surface and their front edges.
  void update(const Complex& surface, std::span<const FaceId> ids);
  OccludingFaces faces;
  std::vector<FrontEdge> fronts;
};
/// All faces of a surface that are alive.
Occluders all_occluders(const Complex& surface);

/// A path bends within support / 1024 of a front edge; twice that covers rounding. The unit is
/// the support.
constexpr double bend_margin = 1.0 / 512;
/// The length of paths from x to a node, below which their distance is less than `support`.
/// `straight`: the straight distance s; the length is (support / s)^¼ s.
double longest_path(double straight, double support);

/// A front edge as a point x sees it, with what bounds the length of paths round it.
struct NearFront {
  const FrontEdge* edge;
  Vec3 middle;              ///< of the edge
  double length, distance;  ///< of the edge; of its middle from x
};
/// The edges whose middles are nearer to x than `reach` and their length. Refers to `edges`.
std::vector<NearFront> fronts_near(const Vec3& x, double reach, std::span<const FrontEdge> edges);

/// A node that `faces` hide from x, as x sees it round one of the edges. With s the straight
/// distance and L the length of the shortest path round an edge, its distance is (L / s)⁴ s. None
/// if that is `support` or more, or if there is no path. Powers of 1 and 2, as in the original
/// criterion, weld a crack behind its front at supports of 1.8 spacings (docs/decisions/041). The
/// distance's gradient is scaled down to a norm of 4 where it is larger (docs/decisions/061).
///
/// A path bends `support` / 1024 ahead of an edge, so that it clears the crack face behind it. Both
/// of its segments are clear of faces (exact), so no path crosses a crack that has no front.
/// `fronts`: those of fronts_near() for a reach of `support` or more.
std::optional<SupportNode> diffracted_support(const Vec3& x, const Vec3& node, double support,
                                              std::span<const NearFront> fronts, const OccludingFaces& faces);

}  // namespace geo
