// The stiffness–vector product of a block of material points, and its gradient and divergence
// operators, in single precision from 16-bit shape gradients.
#pragma once

#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/point_matrices.h"
#include "mechanics/material/stiffness_lanes.h"

namespace geo {

/// Adds Σ Bᵀ D B v to `out`: gradients of the nodal field v, stresses by the modes D, then nodal
/// forces. `values` and `out`: four numbers per node of the block, the last of which is padding.
void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out);

/// point_gradients() in single precision from the quantised shape gradients. `affine` is added to
/// the gradient of each point that has nodes.
void quantised_gradients(const PointBlock& block, const float* values, const Mat3& affine, PointMatrices<double>& out);
/// point_divergence() in single precision from the quantised shape gradients; adds to `out`.
void quantised_divergence(const PointBlock& block, const PointMatrices<double>& stress, float* out);

}  // namespace geo
