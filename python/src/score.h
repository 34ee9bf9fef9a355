// The class Score: walls of a fracture pattern.
#pragma once

#include <cstdint>
#include <memory>

#include "mesh.h"

namespace kerf_python {

/// A score whose sheet is a mesh that Python sees.
struct ScoreResult {
  std::shared_ptr<Mesh> sheet;
  std::uint32_t pieces = 0, chips = 0;
  int attempts = 0;
};

}  // namespace kerf_python
