// Triangles around each vertex, as a quick look at neighbours that cannot cross.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/vec.h"

namespace geo {

/// Of the triangles of a surface, each vertex for itself.
class VertexFans {
 public:
  /// A triangle about a vertex, and the edge across, as the triangle goes round.
  struct Link {
    std::uint32_t from, to, triangle;
  };

  VertexFans() = default;
  VertexFans(const std::vector<Triangle>& triangles, std::size_t vertices);

  std::size_t size() const { return closed_.size(); }
  /// Those that it was made of.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Triangles about vertex v, ascending.
  std::span<const Link> about(std::size_t v) const { return {link_.data() + first_[v], first_[v + 1] - first_[v]}; }
  /// Of vertices with a triangle marked in `changed`, into opens_out (per vertex): whether some direction looks at the
  /// front of all triangles around it, which close around it once; then no two of them have more in common than corners
  /// and edges. `together`: per vertex the row of `at` that says where it is (vertices_together()). Floating point, but
  /// never true where that is not so. Returns those of them that do not, ascending.
  std::vector<std::uint32_t> find_shut(const std::vector<std::uint8_t>& changed,
                                       std::span<const std::uint32_t> together, const std::vector<Vec3>& at,
                                       std::vector<std::uint8_t>& opens_out) const;

  /// use(s, t) for each pair of triangles about v (s < t), but for those that have another vertex in common that
  /// `instead` accepts.
  template <class Instead, class Use>
  void each_pair(std::uint32_t v, const Instead& instead, const Use& use) const {
    const auto links = about(v);
    for (std::size_t i = 0; i < links.size(); ++i)
      for (std::size_t j = i + 1; j < links.size(); ++j) {
        const auto &s = links[i], &t = links[j];
        const auto in_both = [&](std::uint32_t w) { return w == t.from || w == t.to; };
        if ((in_both(s.from) && instead(s.from)) || (in_both(s.to) && instead(s.to))) continue;
        use(s.triangle, t.triangle);
      }
  }

 private:
  // What a triangle shows of its front: its normal, as long as twice its area, and the square of its longest edge.
  struct Front {
    double normal[3], longest;
    Eigen::Map<const Vec3> way() const { return Eigen::Map<const Vec3>(normal); }
  };
  bool open_out(std::uint32_t v, const UninitializedArray<Front>& fronts, std::span<const std::uint32_t> together,
                const std::vector<Vec3>& at) const;

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_;
  std::vector<Link> link_;
  std::vector<std::uint8_t>
      closed_;  // each end of an edge across is another's beginning, and no beginning is twice there
};

}  // namespace geo
