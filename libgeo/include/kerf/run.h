// State of a run between two frames, and statistics of a frame: counts, and seconds by phase.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kerf/body.h"
#include "kerf/contact.h"
#include "kerf/crack.h"
#include "kerf/solid.h"
#include "kerf/vec.h"

namespace geo {

/// A front that a blade's edge leaves, with the edge parameter of each of its points (§ 5.1).
struct EdgeFront {
  FrontState front;
  std::vector<double> at;  ///< per point, ascending: i + t lies between the blade's points i and i + 1
};

/// The front of a crack that grows by stress. The growth direction at point i is tangent × normal,
/// where the tangent follows the order of the points.
struct GrowingFront {
  FrontState front;
  std::vector<Vec3> normal;         ///< per point: of the crack plane, unit, material coordinates
  std::vector<double> owed;         ///< per point: growth that is due but not made, model units
  std::vector<std::uint8_t> ended;  ///< per point: 1 where it has reached a surface, skin or crack
  double length = 0;                ///< largest growth of a point since the front started or branched

  /// Number of points.
  std::size_t size() const { return front.points.size(); }
  /// True where point i is inside the material and may grow.
  bool live(std::size_t i) const { return !ended[i] && front.points[i].id.valid(); }
};

/// Cracks that grow by stress, between two time steps.
struct FractureState {
  std::vector<GrowingFront> fronts;  ///< inside the material, growing or arrested
  std::int32_t cracks = 0;           ///< number of cracks started so far, branches included
};

/// Statistics of fracture by stress.
struct FractureStats {
  std::size_t begun = 0;     ///< cracks started
  std::size_t divided = 0;   ///< branches
  std::size_t advanced = 0;  ///< steps of fronts
  std::size_t refused = 0;   ///< steps that could not be made
};

/// Statistics of a frame, or of a run.
struct FrameStats {
  SplitStats split;  ///< cutting: complex, graph, sampling, binding
  FractureStats fracture;
  ContactStats contact;
  std::size_t refused = 0;      ///< crack steps that could not be made
  std::size_t fronts = 0;       ///< steps of blade fronts tried
  std::size_t newton = 0;       ///< Newton iterations
  std::size_t cg = 0;           ///< conjugate-gradient iterations
  std::size_t steps = 0;        ///< time steps
  double fracture_seconds = 0;  ///< stresses and plans, without the splits
  double front_seconds = 0;     ///< mapping of blades into the material
  double mechanics_seconds = 0, contact_seconds = 0, write_seconds = 0;
  double energy = 0;                  ///< elastic, J, at the frame's end
  std::vector<Vec3> blade_force;      ///< per blade: exerted by the material, N, mean over the frame
  std::vector<Vec3> obstacle_force;   ///< per obstacle, then the ground: exerted by the bodies, N, mean
  std::vector<Vec3> obstacle_torque;  ///< likewise: about the obstacle's origin, N m
  /// Adds counts and seconds; takes energy and forces of `o`.
  FrameStats& operator+=(const FrameStats& o);
  /// Seconds of all phases of cutting.
  double split_seconds() const;
};

/// All that a run needs to continue, in addition to its body.
struct RunState {
  State motion;
  std::vector<std::vector<EdgeFront>> fronts;  ///< per blade: a front for each part of the edge that cuts
  FractureState fracture;
  std::vector<Vec3> surface;              ///< position of each living surface vertex, ascending by id; empty without
                                          ///< self-contact and before the first frame
  std::vector<std::uint32_t> body_index;  ///< per node: its body of the scene
  double time = 0;                        ///< s
  int frame = 0;                          ///< frames computed so far
  FrameStats total;                       ///< counts since the run began; seconds since the program started
};

}  // namespace geo
