// What a run is made of between its frames: what a frame took, in counts and seconds by phase.
#pragma once

#include <cstddef>
#include <vector>

#include "kerf/body.h"
#include "kerf/scene.h"
#include "simulation/fracture_step.h"

namespace geo {

struct FrameStats {
  SplitWork split;  ///< crack: meet and mesh; graph, resample, binding
  FractureStats fracture;
  ContactStats contact;
  std::size_t refused = 0, fronts = 0, newton = 0, cg = 0, steps = 0;
  double fracture_seconds = 0;  ///< stresses and plans, its splits apart
  double front_seconds = 0, mechanics_seconds = 0, contact_seconds = 0, write_seconds = 0;
  double energy = 0;              ///< elastic, J, at the frame's end
  std::vector<Vec3> blade_force;  ///< per blade: what the material does to it, N, mean over the frame
  std::vector<Vec3> obstacle_force, obstacle_torque;  ///< per obstacle, then of the ground on surfaces: what bodies do
                                                      ///< to it, N and N m about its origin, mean over the frame
  FrameStats& operator+=(const FrameStats& o);
  /// Meet and mesh, graph, resample, binding.
  double split_seconds() const;
};

}  // namespace geo
