// Crossings: pairs of triangles of a deformed two-sided surface that intersect. Exact.
//
// Surface vertices that are copies of one vertex of the crack complex (a site) and have equal
// coordinates, to the bit, count as one vertex: the lowest of them represents the others. Two
// triangles cross if they have a common point other than shared vertices and edges. The two sides
// of a face with coincident corners touch, as in every new crack; they do not cross.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/vertex_fans.h"
#include "kerf/vec.h"

namespace geo {

/// Indices of two triangles, the lower one first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// For each vertex the lowest vertex of the same site with the same coordinates. An empty `site`
/// means that all sites differ.
std::vector<std::uint32_t> coincident_representatives(std::span<const std::uint32_t> site,
                                                      const std::vector<Vec3>& positions);

/// Whether two triangles of representatives cross. With `two_sided`, triangles with the same three
/// vertices are the two sides of a face and do not.
bool triangles_cross(const Triangle& s, const Triangle& t, const std::vector<Vec3>& positions, bool two_sided);

/// All pairs of triangles that cross, ascending. `triangles`: of surface vertices, none twice in
/// a triangle. `representative`: coincident_representatives(). With `marked`, only pairs with at
/// least one marked triangle, and the cost follows these.
std::vector<TrianglePair> find_crossings(const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions,
                                         std::span<const std::uint32_t> representative, bool two_sided,
                                         const std::vector<std::uint8_t>* marked = nullptr);

/// As above, among given pairs and in their order.
std::vector<TrianglePair> find_crossings(std::span<const TrianglePair> pairs, const std::vector<Triangle>& triangles,
                                         const std::vector<Vec3>& positions,
                                         std::span<const std::uint32_t> representative, bool two_sided,
                                         const std::vector<std::uint8_t>* marked = nullptr);

/// The crossings of pairs with a common vertex, each once, given the `uncertified` fans and the
/// flags `certified` of all fans (VertexFans::find_uncertified()). Pairs that share a vertex with
/// a certified fan do not cross. `triangles`: of representatives. Only pairs with a triangle
/// marked in `changed`.
std::vector<TrianglePair> crossings_at_vertices(const VertexFans& fans, std::span<const std::uint32_t> uncertified,
                                                const std::vector<std::uint8_t>& certified,
                                                const std::vector<Triangle>& triangles,
                                                const std::vector<Vec3>& positions, bool two_sided,
                                                const std::vector<std::uint8_t>& changed);

}  // namespace geo
