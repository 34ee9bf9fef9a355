// The stiffness of a block of material points times a nodal field, in single precision, from numbers of 16 bits.
#pragma once

#include "mechanics/material_points.h"
#include "mechanics/stiffness_lanes.h"

namespace geo {

/// Adds it to `out`; `values` and `out`: four numbers a node of the block, the last of no account.
void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out);

}  // namespace geo
