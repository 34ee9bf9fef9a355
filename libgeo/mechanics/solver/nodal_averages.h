// Averages of stress over the material points around each node: for pictures and for fracture.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "kerf/solid.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {

/// Weighted sums of the six components of a stress (xx, yy, zz, xy, yz, zx) over points, and the
/// sum of the weights.
using StressSums = std::array<double, 7>;

/// The six components at a point from its material, its deformation gradient F and its elastic part
/// F times the inverse plastic stretch. Returns false where the point is to be left out.
using PointStress = std::function<bool(const Material& material, const Mat3& deformation, const Mat3& elastic,
                                       std::array<double, 6>& out)>;

/// The same for all points of a block from ∇u at each. `out`: eight numbers per point, for a
/// multiple of eight points, zero at first: the six components, 1 where the point counts, and 0.
using BlockStress = std::function<void(std::size_t block, const PointMatrices<double>& gradient, float* out)>;

/// Per node i: Σ_p V_p (1 − |x_p − x_i|² / h_i²)³ σ_p over the material points p that have node i
/// in their shape functions, h_i its support radius. Points without strain are left out. Sums are
/// in single precision and the same for any number of threads.
std::vector<StressSums> nodal_stress_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                          const BlockStress& stress);
/// The same from the stress of single points.
std::vector<StressSums> nodal_stress_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                          const PointStress& stress);

}  // namespace geo
