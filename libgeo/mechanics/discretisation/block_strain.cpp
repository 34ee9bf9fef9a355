#include "mechanics/discretisation/block_strain.h"

#include <algorithm>
#include <optional>

#include "kerf/parallel.h"
#include "mechanics/discretisation/product_lanes.h"

namespace geo {
namespace {

// A point's gradient, if the block's nodes move together and all of its points know what is affine from what is not. Of
// a point in the middle, in the order they have, so that as little as can be is left.
std::optional<Mat3> motion_of(const PointBlock& block, const std::vector<std::uint32_t>& component,
                              const std::vector<Vec3>& u) {
  const auto apart = [&](auto j) { return component[j] != component[block.nodes[0]]; };
  if (block.nodes.empty() || std::any_of(block.nodes.begin(), block.nodes.end(), apart)) return {};
  if (std::any_of(block.points.begin(), block.points.end(),
                  [](const MaterialPoint& p) { return p.rung == Rung::regularised; }))
    return {};
  const std::size_t n = block.points.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (n / 2 + k) % n;
    if (block.points[i].rung != Rung::full) continue;
    Mat3 gradient = Mat3::Zero();
    for (auto q = block.first[i]; q < block.first[i + 1]; ++q)
      gradient += (u[block.nodes[block.to[q]]] - u[block.nodes[0]]) *
                  Eigen::Map<const Vec3>(&block.gradient[3 * std::size_t(q)]).transpose();
    return gradient;
  }
  return {};
}

}  // namespace

BlockStrain::BlockStrain(const MaterialPoints& points) : points_(points) {}

BlockStrain::BlockStrain(const MaterialPoints& points, const std::vector<Vec3>& position,
                         const std::vector<std::uint32_t>& component, const std::vector<Vec3>& first)
    : points_(points), position_(&position), motion_(points.blocks.size()) {
  parallel_for(motion_.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (const auto motion = motion_of(points.blocks[b], component, first)) motion_[b] = {*motion, true};
  });
}

void BlockStrain::gradients(std::size_t block, const std::vector<Vec3>& u, Room& room, Columns<double>& out) const {
  const PointBlock& b = points_.blocks[block];
  if (!loose(block)) {
    points_.values(block, u, room.values);
    point_gradients(b, room.values.data(), out);
    for (auto& column : out.column) std::fill(column.begin() + 4 * std::ptrdiff_t(b.points.size()), column.end(), 0.0);
    return;
  }
  const Mat3& carried = motion_[block].gradient;
  room.few.resize(std::max(room.few.size(), 4 * b.nodes.size()));
  const Vec3 &u0 = u[b.nodes[0]], &x0 = (*position_)[b.nodes[0]];
  for (std::size_t k = 0; k < b.nodes.size(); ++k) {
    const Vec3 own = (u[b.nodes[k]] - u0) - carried * ((*position_)[b.nodes[k]] - x0);
    for (int c = 0; c < 3; ++c) room.few[4 * k + std::size_t(c)] = float(own[c]);
    room.few[4 * k + 3] = 0;
  }
  rounded_gradients(b, room.few.data(), carried, out);
}

void BlockStrain::pull(std::size_t block, const Columns<double>& stress, Room& room, double* out) const {
  const PointBlock& b = points_.blocks[block];
  if (!loose(block)) {
    std::fill_n(out, 4 * b.nodes.size(), 0.0);
    return point_divergence(b, stress, out);
  }
  room.few.assign(std::max(room.few.size(), 4 * b.nodes.size()), 0);
  rounded_divergence(b, stress, room.few.data());
  std::copy_n(room.few.begin(), 4 * b.nodes.size(), out);
}

}  // namespace geo
