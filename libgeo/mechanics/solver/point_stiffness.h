// The stiffness of all material points at one linearisation.
#pragma once

#include <vector>

#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/material/stress_derivative.h"

namespace geo {

/// ∂²Ψ/∂F² per point with negative eigenvalues left out, in the frame of the singular value
/// decomposition of F.
struct PointStiffness {
  std::vector<StiffnessModes> modes;       ///< per block; no points: all of it sleeps
  std::vector<std::vector<float>> weight;  ///< per block and point: volume, m³; zero for rigid points and padding
};

}  // namespace geo
