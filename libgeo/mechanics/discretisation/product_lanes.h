// The stiffness of a block of material points times a nodal field, and its gradients, in single precision, from numbers
// of 16 bits.
#pragma once

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/point_lanes.h"
#include "mechanics/discretisation/stiffness_lanes.h"

namespace geo {

/// Adds it to `out`; `values` and `out`: four numbers a node of the block, the last of no account.
void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out);

/// As point_gradients() and point_divergence() in single precision, of the same numbers. `carried` is added to each
/// gradient but those of points that see nothing.
void rounded_gradients(const PointBlock& block, const float* values, const Mat3& carried, Columns<double>& out);
void rounded_divergence(const PointBlock& block, const Columns<double>& stress, float* out);

}  // namespace geo
