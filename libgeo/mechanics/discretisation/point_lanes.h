// Gradients at material points and forces from their stresses, three coordinates side by side.
#pragma once

#include <cstddef>
#include <vector>

#include "mechanics/discretisation/material_points.h"

namespace geo {

/// Matrices of points by columns: column c of point i is at column[c] + 4 i, its fourth number is of no account.
template <class Number>
struct Columns {
  std::vector<Number> column[3];
  void resize(std::size_t points);
};

/// ∇ of a nodal field at the points of a block; `values`: four numbers a node of the block, the last of no account.
void point_gradients(const PointBlock& block, const double* values, Columns<double>& out);
/// Adds Σ stress · shape gradient of the block's points to four numbers a node of the block.
void point_divergence(const PointBlock& block, const Columns<double>& stress, double* out);
/// Adds eight numbers of each point, times a weight, to those of its nodes; nothing where the seventh is zero. The
/// weight is the point's volume times the kernel, without its scale. `place`: of each node of the block its
/// coordinates, from `base` on, and 1 / support².
void point_shares(const PointBlock& block, const Vec3& base, const float* place, const float* own, float* out);

}  // namespace geo
