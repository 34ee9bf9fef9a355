// Loose blocks: ∇u = A + Σ_j (u_j − u_0 − A (x_j − x_0)) g_jᵀ with the sum in single precision. A
// is the displacement gradient of one point of the block at the start of the step, g_j the shape
// gradients.
#include "mechanics/discretisation/block_strain.h"

#include <algorithm>
#include <optional>

#include "kerf/parallel.h"
#include "mechanics/discretisation/stiffness_product_lanes.h"

namespace geo {
namespace {

// The displacement gradient at u of a good point near the middle of the block, so that the residual
// displacements are small. None if the nodes belong to several components or a point is poor, which
// would not reproduce affine fields.
std::optional<Mat3> affine_gradient(const PointBlock& block, const std::vector<std::uint32_t>& component,
                                    const std::vector<Vec3>& u) {
  const auto is_foreign = [&](auto j) { return component[j] != component[block.nodes[0]]; };
  if (block.nodes.empty() || std::any_of(block.nodes.begin(), block.nodes.end(), is_foreign)) return {};
  if (std::any_of(block.points.begin(), block.points.end(),
                  [](const MaterialPoint& p) { return p.quality == MomentQuality::poor; }))
    return {};
  const std::size_t n = block.points.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (n / 2 + k) % n;
    if (block.points[i].quality != MomentQuality::good) continue;
    Mat3 gradient = Mat3::Zero();
    for (auto q = block.entry_begin[i]; q < block.entry_begin[i + 1]; ++q)
      gradient += (u[block.nodes[block.entry_node[q]]] - u[block.nodes[0]]) *
                  Eigen::Map<const Vec3>(&block.entry_gradient[3 * std::size_t(q)]).transpose();
    return gradient;
  }
  return {};
}

}  // namespace

BlockStrain::BlockStrain(const MaterialPoints& points) : points_(points) {}

BlockStrain::BlockStrain(const MaterialPoints& points, const std::vector<Vec3>& position,
                         const std::vector<std::uint32_t>& component, const std::vector<Vec3>& start)
    : points_(points), position_(&position), motion_(points.blocks.size()) {
  parallel_for(motion_.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (const auto gradient = affine_gradient(points.blocks[b], component, start)) motion_[b] = {*gradient, true};
  });
}

void BlockStrain::gradients(std::size_t block, const std::vector<Vec3>& u, Scratch& scratch,
                            PointMatrices<double>& out) const {
  const PointBlock& b = points_.blocks[block];
  if (!is_loose(block)) {
    points_.gather(block, u, scratch.values);
    point_gradients(b, scratch.values.data(), out);
    for (auto& column : out.column) std::fill(column.begin() + 4 * std::ptrdiff_t(b.points.size()), column.end(), 0.0);
    return;
  }
  const Mat3& affine = motion_[block].gradient;
  scratch.single.resize(std::max(scratch.single.size(), 4 * b.nodes.size()));
  const Vec3 &u0 = u[b.nodes[0]], &x0 = (*position_)[b.nodes[0]];
  for (std::size_t k = 0; k < b.nodes.size(); ++k) {
    const Vec3 residual = (u[b.nodes[k]] - u0) - affine * ((*position_)[b.nodes[k]] - x0);
    for (int c = 0; c < 3; ++c) scratch.single[4 * k + std::size_t(c)] = float(residual[c]);
    scratch.single[4 * k + 3] = 0;
  }
  quantised_gradients(b, scratch.single.data(), affine, out);
}

void BlockStrain::nodal_forces(std::size_t block, const PointMatrices<double>& stress, Scratch& scratch,
                               double* out) const {
  const PointBlock& b = points_.blocks[block];
  if (!is_loose(block)) {
    std::fill_n(out, 4 * b.nodes.size(), 0.0);
    return point_divergence(b, stress, out);
  }
  scratch.single.assign(std::max(scratch.single.size(), 4 * b.nodes.size()), 0);
  quantised_divergence(b, stress, scratch.single.data());
  std::copy_n(scratch.single.begin(), 4 * b.nodes.size(), out);
}

}  // namespace geo
