// Some rows of contact, by row and by node, so that sums at nodes are made by all threads without waiting for each
// other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "mechanics/terms/potential.h"

namespace geo {

class RowLists {
 public:
  struct Share {
    std::uint32_t of;  ///< a node, or a row
    float weight;
  };
  RowLists() = default;
  /// Of the rows that are named, each a number in `entries`.
  RowLists(std::span<const std::uint32_t> rows, const std::vector<std::span<const NodeWeight>>& entries,
           std::size_t nodes);

  /// How many rows are in it; which one the k-th is, and its nodes, in single precision.
  std::size_t size() const { return rows_.size(); }
  std::uint32_t row(std::size_t k) const { return rows_[k]; }
  std::span<const Share> of_row(std::size_t k) const {
    return {own_.data() + first_own_[k], own_.data() + first_own_[k + 1]};
  }
  /// The rows that a node is in, ascending.
  std::span<const Share> of_node(std::size_t node) const {
    return size() == 0
               ? std::span<const Share>()
               : std::span<const Share>{shares_.data() + first_share_[node], shares_.data() + first_share_[node + 1]};
  }
  /// Weights there in double precision.
  const double* weights_of_node(std::size_t node) const { return weights_.data() + first_share_[node]; }

 private:
  std::vector<std::uint32_t> rows_;
  std::vector<std::size_t> first_own_, first_share_;
  UninitializedArray<Share> own_, shares_;
  UninitializedArray<double> weights_;
};

}  // namespace geo
