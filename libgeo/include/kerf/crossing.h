// When two triangles of a deformed two-sided surface cross.
//
// Copies of one site (a vertex of the crack complex) that stand at the same coordinates, to the bit, count as one
// vertex. Two triangles cross when they have a point in common besides the corners and edges that they share. Two sides
// of one face with all three corners at the same coordinates touch, as every fresh crack does; they do not cross.
// Exact.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/box_tree.h"
#include "contact/detection/vertex_fans.h"
#include "kerf/mesh.h"

namespace geo {

/// For each vertex the lowest row with the same site and the same coordinates. `site` empty: each for itself.
std::vector<std::uint32_t> vertices_together(std::span<const std::uint32_t> site, const std::vector<Vec3>& positions);

/// Whether two triangles of rows that stand for others cross.
bool triangles_cross(const Triangle& s, const Triangle& t, const std::vector<Vec3>& positions, bool two_sided);

/// Pairs of triangles that cross, ascending. `together` from vertices_together(); `two_sided`: two triangles with the
/// same three corners are two sides of a face, and touch. No triangle has a vertex twice. Only pairs with a triangle
/// marked in `only`, where given: then each is tested for itself, else those about a vertex all at once where they open
/// out (vertex_fans.h).
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(const std::vector<Triangle>& triangles,
                                                                    const std::vector<Vec3>& positions,
                                                                    std::span<const std::uint32_t> together,
                                                                    bool two_sided,
                                                                    const std::vector<std::uint8_t>* only = nullptr);

/// The same among given pairs of triangles, in their order.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(
    std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Triangle>& triangles,
    const std::vector<Vec3>& positions, std::span<const std::uint32_t> together, bool two_sided,
    const std::vector<std::uint8_t>* only = nullptr);

/// Of pairs of triangles (of rows that stand for others) about the vertices `shut`, one of each pair marked in
/// `changed`: those that cross, each once. Where two have more vertices in common, and one of them opens out, they do
/// not.
std::vector<std::pair<std::uint32_t, std::uint32_t>> crossings_about(const VertexFans& fans,
                                                                     std::span<const std::uint32_t> shut,
                                                                     const std::vector<std::uint8_t>& opens_out,
                                                                     const std::vector<Triangle>& triangles,
                                                                     const std::vector<Vec3>& positions, bool two_sided,
                                                                     const std::vector<std::uint8_t>& changed);

/// How many pairs of triangles of surfaces cross, one after the other: where one has the same triangles as the one
/// before, what is about its vertices is known, and which triangles are near each other is looked for in the same
/// order.
class CrossingCounter {
 public:
  std::size_t count(const TriangleMesh& surface);

 private:
  VertexFans fans_;
  BoxTree tree_;
};

/// The same of one surface: of a frame, or of a plain mesh.
std::size_t count_crossings(const TriangleMesh& surface);

}  // namespace geo
