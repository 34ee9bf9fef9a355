// Displacement gradients at the material points of a block, and nodal forces from their stresses,
// in vector registers.
#pragma once

#include <cstddef>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/point_matrices.h"

namespace geo {

/// ∇u at the points of a block. `values`: u at the block's nodes, four numbers each (the last is
/// padding).
void point_gradients(const PointBlock& block, const double* values, PointMatrices<double>& out);
/// Adds Σ stress · shape gradient over the block's points to `out`, four numbers per node of the
/// block.
void point_divergence(const PointBlock& block, const PointMatrices<double>& stress, double* out);
/// out_j += Σ_p V_p (1 − |x_p − x_j|² / h_j²)³ numbers_p over the points p whose shape functions
/// have node j: eight numbers per point and node, weighted by volume and the kernel without its
/// scale. Points whose seventh number is zero are skipped. `place`: per node of the block its
/// coordinates relative to `base`, and 1 / h², h its support radius.
void add_kernel_weighted(const PointBlock& block, const Vec3& base, const float* place, const float* numbers,
                         float* out);

}  // namespace geo
