// The scene that tests of materials begin with: one body without weight, drag or refined nodes.
#pragma once

#include "kerf/scene.h"

/// A scene of one body whose nodes have one spacing, of 10⁵ Pa and 1000 kg/m³, without gravity and
/// damping.
inline geo::Scene single_body_scene(double spacing) {
  geo::Scene s;
  s.bodies.resize(1);
  s.bodies[0].sampling.spacing = spacing;
  s.bodies[0].sampling.levels = 1;
  s.material = {.young = 1e5, .poisson = 0.3, .density = 1000, .damping = 0};
  s.gravity = geo::Vec3::Zero();
  return s;
}
