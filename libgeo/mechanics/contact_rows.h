// The rows of all that acts on nodes besides elasticity in a time step, beside each other: what they make depend on each other, and their product.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mechanics/potential.h"

namespace geo {

class ContactRows {
 public:
  /// Of all of these, which outlive it, after their begin(); until read() no row does anything.
  ContactRows(std::span<Potential* const> potentials, std::size_t nodes);
  /// Pairs that join the parts of all nodes of each row, where `part` is each node's; none of a part with itself.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> couples(std::span<const std::uint32_t> part) const;
  /// Takes over the curvatures of the potentials' last force().
  void read();
  /// ∂²E/∂u² p; then what a node has of it.
  void multiply(const std::vector<Vec3>& p);
  Vec3 product_at(std::size_t node) const {
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (auto i = first_share_[node]; i < first_share_[node + 1]; ++i) sum += shares_[i].weight * pull_[shares_[i].of];
    return sum.head<3>().cast<double>();
  }
  /// Adds for each node a 3×3 block, N/m, for a preconditioner: that of ∂²E/∂u², and more where a row's weight is spread over many nodes, as those near
  /// each other move together.
  void add_blocks(std::vector<Mat3>& out) const;

 private:
  std::span<Potential* const> potentials_;
  std::vector<std::span<const NodeWeight>> entries_;  // of each row, where its potential has them
  std::vector<Mat3> curvature_;
  // Of rows that do something, in single precision: by row, and by node so that threads need not wait for each other.
  struct Share {
    std::uint32_t of;  // a node, or a number in active_
    float weight;
  };
  std::vector<std::uint32_t> active_;
  std::vector<std::size_t> first_own_, first_share_;
  std::vector<Share> own_, shares_;
  std::vector<Eigen::Vector4f> pull_;  // of each that is active: what it has for its nodes, but for their weights
};

}  // namespace geo
