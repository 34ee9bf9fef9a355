// Numbered things that are joined two by two: who hangs together with whom (union by the lowest, path halving).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace geo {

class Joined {
 public:
  explicit Joined(std::size_t count) : up_(count) { std::iota(up_.begin(), up_.end(), 0u); }
  /// The lowest of those that i hangs together with, itself included.
  std::uint32_t operator[](std::uint32_t i) {
    while (up_[i] != i) i = up_[i] = up_[up_[i]];
    return i;
  }
  /// The same, by as many threads as want to know.
  std::uint32_t lowest(std::uint32_t i) const {
    while (up_[i] != i) i = up_[i];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = (*this)[a], b = (*this)[b];
    up_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> up_;
};

}  // namespace geo
