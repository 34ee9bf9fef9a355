// Fans of triangles around vertices, as a filter: triangles of a fan that is a height field do not
// cross.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/vec.h"

namespace geo {

/// The triangles around each vertex of a surface (its fan).
class VertexFans {
 public:
  /// A triangle of a fan, and its edge opposite the vertex, in the triangle's orientation.
  struct Link {
    std::uint32_t from, to, triangle;
  };

  /// The fans of no vertices.
  VertexFans() = default;
  /// The fans of the vertices 0, …, vertices − 1. Copies the triangles.
  VertexFans(const std::vector<Triangle>& triangles, std::size_t vertices);

  /// Number of vertices.
  std::size_t size() const { return closed_.size(); }
  /// The triangles of the surface.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// The fan of vertex v, by ascending triangles.
  std::span<const Link> fan(std::size_t v) const { return {link_.data() + first_[v], first_[v + 1] - first_[v]}; }

  /// Certifies fans as height fields: some direction sees the front of all triangles of the fan,
  /// which closes around the vertex exactly once. No two triangles of such a fan have more in
  /// common than shared vertices and edges. Updates `certified` (per vertex) for the vertices of
  /// triangles marked in `changed`. Returns the uncertified ones among these vertices, ascending.
  /// `representative`: coincident_representatives(), by which `at` gives positions. Floating
  /// point, but conservative.
  std::vector<std::uint32_t> find_uncertified(const std::vector<std::uint8_t>& changed,
                                              std::span<const std::uint32_t> representative,
                                              const std::vector<Vec3>& at, std::vector<std::uint8_t>& certified) const;

  /// Calls visit(s, t) for each pair of triangles s < t of the fan of v, except pairs with
  /// another common vertex w for which skip(w) is true. With skip(w) = (w < v), the calls for all
  /// v visit each pair with a common vertex once.
  template <class Skip, class Visit>
  void for_each_pair(std::uint32_t v, const Skip& skip, const Visit& visit) const {
    const auto links = fan(v);
    for (std::size_t i = 0; i < links.size(); ++i)
      for (std::size_t j = i + 1; j < links.size(); ++j) {
        const auto &s = links[i], &t = links[j];
        const auto in_t = [&](std::uint32_t w) { return w == t.from || w == t.to; };
        if ((in_t(s.from) && skip(s.from)) || (in_t(s.to) && skip(s.to))) continue;
        visit(s.triangle, t.triangle);
      }
  }

 private:
  // The normal of a triangle, as long as twice its area, and the square of its longest edge.
  struct Front {
    double components[3], longest;
    /// The components as a vector.
    Eigen::Map<const Vec3> normal() const { return Eigen::Map<const Vec3>(components); }
  };
  bool is_height_field(std::uint32_t v, const UninitializedArray<Front>& fronts,
                       std::span<const std::uint32_t> representative, const std::vector<Vec3>& at) const;

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_;  // of each vertex in link_
  std::vector<Link> link_;
  std::vector<std::uint8_t> closed_;  // per vertex: each opposite edge continues exactly one other
};

}  // namespace geo
