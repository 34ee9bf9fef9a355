// Supports of material points: the nodes whose support holds a point and which it sees, straight
// ahead or round the front of a crack. Supports are widened until a point sees enough nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "kerf/body.h"
#include "mechanics/discretisation/diffraction.h"
#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/nearby_occluders.h"

namespace geo {

/// Factors of the support radii, powers of 1.2, that are tried in turn while a point sees too few
/// nodes.
constexpr std::array support_factors{1.0, 1.2, 1.44, 1.728, 2.0736};

/// The position of a point that is intended at p. A point on a face belongs to neither side, so it
/// is moved towards the nearest node by a small fraction of the distance.
Vec3 moved_off_faces(const Body& body, const Vec3& p);

/// The nodes whose supports, `factor` times as wide, may hold a point of a box, ascending.
/// `largest_radius`: of all nodes.
std::vector<std::uint32_t> supporting_nodes(const Body& body, const Box3& box, double factor, double largest_radius);

/// Possible changes of visibility since a set of points was computed.
class VisibilityChanges {
 public:
  /// `faces`: added or removed since. `nodes`: those that are new, have moved, or have another
  /// support radius, of `node_count` in all.
  VisibilityChanges(std::span<const std::array<Vec3, 3>> faces, std::span<const std::uint32_t> nodes,
                    std::size_t node_count);
  /// The faces.
  const TriangleBvh& faces() const { return faces_; }
  /// Whether a node has changed.
  bool has_changed(std::uint32_t node) const { return node_[node] != 0; }
  /// Appends the faces that lines of sight of points in a box may touch, bent ones included.
  /// `radius`: the largest influence radius of the points.
  void faces_near(const Box3& points, double radius, std::vector<std::uint32_t>& faces) const;
  /// Whether one of `faces` may touch a point.
  bool may_touch(const Vec3& x, std::span<const std::uint32_t> faces) const {
    return std::any_of(faces.begin(), faces.end(), [&](auto f) { return boxes_[f].meets({x, x}); });
  }
  /// Those of `faces` that lines of sight of a point may touch, with `radius` the point's.
  std::vector<std::uint32_t> faces_near(const Vec3& x, double radius, std::span<const std::uint32_t> faces) const;
  /// Faces, and how far they are from a point x.
  struct NearFaces {
    /// Whether one of the faces may touch a path from x to a node that is shorter than its support
    /// admits.
    bool meet_bent_paths(const Vec3& node, double support) const;

    struct Face {
      Vec3 middle;                    ///< of a ball about the face
      double twice_radius, distance;  ///< twice the radius of the ball; of its middle from x
      const std::array<Vec3, 3>* corners;
    };
    Vec3 x;
    std::vector<Face> faces;
  };
  /// Some `faces`, which are those of faces_near() for x. Refers to this object.
  NearFaces seen_from(const Vec3& x, std::span<const std::uint32_t> faces) const;

 private:
  TriangleBvh faces_;
  std::vector<Box3> boxes_;         // per face
  std::vector<Ball> balls_;         // per face
  std::vector<std::uint8_t> node_;  // per node: 1 if it has changed
};

/// A point whose shape gradients are to be computed. In: its position, and as `influence_radius`
/// the distance from its intended position. `before`: the block where it was point number
/// `point_before`, or null.
struct SupportTask {
  MaterialPoint* point;
  ShapeGradients* shape;
  const PointBlock* before = nullptr;
  std::size_t point_before = 0;
  bool with_values = false;  ///< whether ShapeGradients::value is computed, too
};
/// Computes the shape gradients of a point again, with values, from the nodes that it is known to
/// see. False, and nothing computed, where it sees one of them round a front. Precondition: the
/// point is not singular, and nothing has changed since it was computed.
bool straight_shape(const Body& body, const PointBlock& block, std::size_t point, ShapeGradients& shape);

/// Computes the shape gradients, and all members of the points except volumes. Consecutive tasks
/// should be near each other. `occluders`: those of the whole surface; null: nearby ones are
/// queried. `changes`: since the blocks `before` of the tasks; lines of sight that they do not
/// touch are not tested again, with the same result. Null: all are tested. `component`: per node,
/// of the visibility graph. A point sees nodes of one component only, so no paths to others are
/// tried, and points of components with few nodes try fewer factors, with the same result. Empty:
/// all are tried. `kept`: nearby occluders, kept for later calls. Null: none.
void compute_supports(const Body& body, std::vector<SupportTask> tasks, const Occluders* occluders = nullptr,
                      const VisibilityChanges* changes = nullptr, std::span<const std::uint32_t> component = {},
                      NearbyOccluders* kept = nullptr);

}  // namespace geo
