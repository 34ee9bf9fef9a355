// The motion of a solid's nodes, and the external actions on them during a time step.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

class Potential;

/// The motion of a solid at one instant.
struct State {
  std::vector<Vec3> displacement;       ///< per node, model units
  std::vector<Vec3> velocity;           ///< per node, model units per second
  std::vector<Vec3> acceleration = {};  ///< per node, of the last time step, for the inertial predictor; empty: unknown
  std::vector<Mat3> plastic = {};       ///< per material point: plastic part of the Green strain; empty: none yet
};

/// External actions on the nodes: gravity, loads, clamps, the ground, contact.
struct Environment {
  Vec3 gravity = {0, 0, -9.81};        ///< acceleration, m/s²
  bool ground = false;                 ///< whether there is a ground plane
  Vec3 ground_point = Vec3::Zero();    ///< any point of the ground plane
  Vec3 ground_normal = Vec3::UnitZ();  ///< unit normal of the ground plane, out of the ground
  double ground_stiffness = 1e4;       ///< penalty per node mass: acceleration per unit of depth, 1/s²
  double friction = 0.5;               ///< share of its tangential velocity that a touching node loses in 0.01 s
  std::vector<double> clearance;       ///< per node: distance to the skin below it; empty: none
  std::vector<std::uint8_t> fixed;     ///< per node: 1 clamps it; empty: no node is clamped
  std::vector<Vec3> load;              ///< per node: a force, N; empty: none
  std::vector<Potential*> contact;     ///< contact potentials, not owned; empty: no contact
};

}  // namespace geo
