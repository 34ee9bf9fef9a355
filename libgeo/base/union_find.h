// Disjoint sets of the integers 0, …, n − 1: union–find with path halving (Tarjan, van Leeuwen
// 1984).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace geo {

/// Disjoint sets whose representative is always their lowest element, so that results do not depend
/// on the order of unions.
class UnionFind {
 public:
  /// `count` sets of one element each.
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  /// The lowest element of the set of i. Shortens paths, hence not thread-safe.
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// As find(), without shortening paths: several threads may call it while no set changes.
  std::uint32_t find_shared(std::uint32_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  /// Merges the sets of a and b.
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace geo
