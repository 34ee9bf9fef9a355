// Groups of coincident vertices: copies of one site at one position, which move as one.
#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace geo {

/// The vertices that each vertex represents.
class CoincidentVertices {
 public:
  /// `representative`: per vertex (coincident_representatives()).
  explicit CoincidentVertices(std::span<const std::uint32_t> representative)
      : first_(representative.size() + 1, 0), vertex_(representative.size()) {
    for (const auto v : representative) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t v = 0; v < representative.size(); ++v) vertex_[next[representative[v]]++] = v;
  }
  /// `count` vertices, each in a group of its own.
  static CoincidentVertices all_distinct(std::size_t count) {
    std::vector<std::uint32_t> itself(count);
    std::iota(itself.begin(), itself.end(), 0u);
    return CoincidentVertices(itself);
  }

  /// Number of vertices.
  std::size_t size() const { return vertex_.size(); }
  /// The group of representative v, itself included, ascending. Empty if v represents nothing.
  std::span<const std::uint32_t> operator[](std::size_t v) const {
    return {vertex_.data() + first_[v], first_[v + 1] - first_[v]};
  }

 private:
  std::vector<std::uint32_t> first_, vertex_;
};

}  // namespace geo
