// The edge of a stroke, which follows the path that its pointer has drawn.
#pragma once

#include <optional>
#include <vector>

#include <kerf/scene.h>
#include "live/command.h"

namespace live {

/// An edge between two frames. Lengths are in model units.
class MovingEdge {
 public:
  /// Begins with its stroke.
  explicit MovingEdge(const Stroke& stroke)
      : now_{stroke.origin, stroke.direction}, length_(stroke.depth), above_(stroke.above) {}

  /// Appends the poses of a stroke that goes on.
  void add_path(const Stroke& stroke);
  /// Gives up the path that is left: the edge stays where it is.
  void stop() { path_.clear(); }
  /// Moves along the path for a frame, no farther than `most`, so that a frame has a bounded cost.
  /// An edge that a fast pointer has left behind catches up. In a frame an edge moves straight, so
  /// it stops where the path bends. `spacing`: of the finest nodes.
  void advance(double most, double spacing);

  /// Where it is.
  const EdgePose& now() const { return now_; }
  /// From one end to the other.
  double length() const { return length_; }
  /// Whether it is where its pointer is.
  bool has_arrived() const { return path_.empty(); }
  /// Whether it has moved, so that it has a back.
  bool has_back() const { return back_ != geo::Vec3::Zero(); }
  /// A pose with this edge along local z, and the back of the blade along local x. Precondition:
  /// has_back().
  geo::Pose pose_at(const EdgePose& edge) const;
  /// The pose now. Precondition: has_back().
  geo::Pose pose() const;

 private:
  void chase(double most, double spacing);
  void turn(const EdgePose& before, double spacing);

  EdgePose now_;
  std::vector<EdgePose> path_;  // poses that the edge has still to pass; the last one is the pointer's
  double length_;
  std::optional<double> above_;         // of an edge that follows the surface: from its origin to there
  geo::Vec3 back_ = geo::Vec3::Zero();  // unit, from the edge against its motion; zero before it has moved
};

}  // namespace live
