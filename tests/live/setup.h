// The setup that sessions of the tests begin with: one body, as kerf-live adapts its scene.
#pragma once

#include <string>

#include <kerf/mesh.h>
#include "live/session.h"

namespace live {

/// A scene of one body with self-contact, by the tables given before [contact].
inline sim::Setup setup_of(const std::string& tables, const geo::TriangleMesh& mesh) {
  sim::Setup s;
  s.scene = geo::parse_scene(tables + "[contact]\nself = true\n[time]\naccuracy = 0.01\n", "s.toml");
  s.models = geo::place_models(s.scene, {mesh});
  adapt_scene(s.scene, 60, true);
  return s;
}

}  // namespace live
