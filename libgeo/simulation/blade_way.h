// The way of a blade through the material in a time step: blade and nodes both move (§ 5.1).
#pragma once

#include <span>
#include <vector>

#include "kerf/scene.h"
#include "kerf/solid.h"
#include "mechanics/discretisation/inverse_deformation.h"
#include "mechanics/discretisation/nodal_gradients.h"
#include "simulation/edge_front.h"

namespace geo {

class FrontAnchor;

/// The motion of nodes in a time step that they have made: straight, at a constant speed.
class NodeWay {
 public:
  NodeWay() = default;
  /// From displacements `before` the step to `after` it, per node.
  NodeWay(const std::vector<Vec3>& before, const std::vector<Vec3>& after);
  /// New nodes move as their donors; see BodyDelta::donors. Does nothing before the first step.
  void add_nodes(std::span<const NodeId> donors);
  /// Displacements at a fraction of the step. `after`: those at its end, of all nodes.
  std::vector<Vec3> at(const std::vector<Vec3>& after, double fraction) const;
  /// That of one node, in the step.
  const Vec3& of(NodeId node) const { return way_[node.index()]; }
  /// The length of the longest.
  double longest() const;

 private:
  std::vector<Vec3> way_;
};

/// A body that has made a time step. Refers to data of the caller.
struct MovedBody {
  const Body& body;
  const Solid& solid;
  const State& motion;  ///< at the end of the step
  const NodeWay& way;
  double begin, end;  ///< of the step, s
};

/// The map from the world to the material at a fraction of a time step.
class MapAt {
 public:
  /// For the surroundings of the blade at that time. `moved` must outlive the object.
  MapAt(const MovedBody& moved, const Blade& blade, double fraction);
  /// For a box.
  MapAt(const MovedBody& moved, const Blade& blade, double fraction, const Box3& box);
  MapAt(const MapAt&) = delete;
  MapAt& operator=(const MapAt&) = delete;
  /// The map.
  const InverseDeformation& map() const { return map_; }
  /// The pose of the blade.
  const Pose& pose() const { return pose_; }

 private:
  Pose pose_;
  std::vector<Vec3> displacement_;
  LazyNodalGradients gradient_;
  InverseDeformation map_;
};

/// The number of cuts in which a blade goes its way: ⌈farthest / (limit · finest)⌉, at most 64.
/// farthest is the longest way of a point of the blade through the material, or past the nodes in
/// the world where the former is more than twice the latter; finest is the smallest node spacing
/// (§ 5.1). A place of the edge that is outside the body before and after the step counts where it
/// passes through; segments between such points are sampled. `fronts`: of the blade.
int number_of_cuts(const MovedBody& moved, const Blade& blade, std::span<const EdgeFront> fronts);

/// The largest distance of the surface that the edge has swept, mapped into the material, from the
/// strips between a front and its next position, in node spacings. It is measured half way between
/// the points of the front, at half the time of the cut. `half`: the map at that time; `anchor`:
/// corrects it as it has corrected `to`.
double sheet_deviation(const Body& body, const MapAt& half, const Blade& blade, const EdgeFront& from,
                       std::span<const Vec3> to, const FrontAnchor& anchor);

/// The largest angle between two of the faces, and between them and their neighbours in the same
/// crack, in degrees. Triangles lower than `lowest`, model units, do not count.
double sheet_turning(const Complex& surface, std::span<const FaceId> faces, double lowest);

/// The number of pieces with less than a tenth of the mean volume of a node.
std::size_t count_crumbs(const Body& body);

}  // namespace geo
