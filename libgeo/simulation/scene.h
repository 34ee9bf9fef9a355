// A scene: one body, blades that cut it, the ground, and how time goes.
#pragma once

#include <string>
#include <vector>

#include "mechanics/solid.h"
#include "sampling/sample.h"
#include "simulation/fracture.h"

namespace geo {

/// A rigid curve that cuts where it moves: a polyline in its own coordinates, placed by keyframes.
struct Blade {
  struct Key {
    double time = 0;
    Vec3 position = Vec3::Zero();
    Vec3 axis = Vec3::UnitZ();
    double angle = 0;  ///< degrees about axis
  };
  std::string name;
  std::vector<Vec3> points;
  std::vector<Key> keys;  ///< ascending in time, at least two
  bool closed = false;

  bool active(double time) const { return time >= keys.front().time && time <= keys.back().time; }
  /// World positions of the points: position interpolated linearly, rotation spherically.
  std::vector<Vec3> at(double time) const;
};

struct Scene {
  std::string mesh;  ///< path, relative to the scene file unless absolute
  SampleOptions sampling;
  double spacing_percent = 5;  ///< of the diagonal, when sampling.spacing and count are 0
  int k = 26;
  Material material;
  std::vector<std::array<Vec3, 2>> fixed;  ///< boxes, material coordinates: nodes inside stay where they are
  Vec3 velocity = Vec3::Zero();            ///< at the start
  bool ground = false;
  Vec3 ground_point = Vec3::Zero(), ground_normal = Vec3::UnitZ();
  double ground_stiffness = 1e5, friction = 0.5;
  Vec3 gravity = {0, 0, -9.81};
  double frame_rate = 24, dt = 1.0 / 96;
  int frames = 24, checkpoint_every = 8;
  bool implicit = true;
  std::uint64_t seed = 1;
  std::vector<Blade> blades;
  Fracture fracture;
};

}  // namespace geo
