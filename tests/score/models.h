// The models that scores are tried on.
#pragma once

#include <string>
#include <vector>

#include "invariants/models.h"
#include "kerf/mesh.h"

namespace score_models {

/// Small models first, which the suite uses; those named by lower-case files are scans.
inline const std::vector<std::string> names{
    "joint",   "apple", "cactus",       "letter K", "helmet", "rotor", "polyp",       "spool", "plate",   "hand",
    "pumpkin", "knot1", "couplingdown", "elephant", "dino",   "femur", "triceratops", "homer", "retinal", "bear"};

/// The model of a name: one of the above, "ball", "cube" or "letter" with a capital letter.
inline geo::TriangleMesh model_of(const std::string& name) {
  if (name == "apple") return geo::make_apple(10);
  if (name == "ball") return geo::make_sphere(12);
  if (name == "cube") return geo::make_block({1, 1, 1}, 0.1);
  if (name.starts_with("letter ")) return geo::make_letter(name.back(), 0.25, 16);
  if (name == "polyp") return geo::make_polyp(10);
  if (name == "plate") return geo::make_block({2, 1, 0.12}, 0.1);
  return invariants::model(name);
}

}  // namespace score_models
