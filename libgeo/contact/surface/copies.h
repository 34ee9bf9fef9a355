// Which vertices of the surface move as one.
#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace geo {

/// For each vertex those that it stands for, itself included, ascending; none where another stands for it.
class Copies {
 public:
  /// `together`: per vertex the one that stands for it (vertices_together()).
  explicit Copies(std::span<const std::uint32_t> together) : first_(together.size() + 1, 0), row_(together.size()) {
    for (const auto v : together) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t v = 0; v < together.size(); ++v) row_[next[together[v]]++] = v;
  }
  static Copies each_alone(std::size_t count) {
    std::vector<std::uint32_t> itself(count);
    std::iota(itself.begin(), itself.end(), 0u);
    return Copies(itself);
  }

  std::size_t size() const { return row_.size(); }
  std::span<const std::uint32_t> operator[](std::size_t v) const {
    return {row_.data() + first_[v], first_[v + 1] - first_[v]};
  }

 private:
  std::vector<std::uint32_t> first_, row_;
};

}  // namespace geo
