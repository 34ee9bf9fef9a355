// Edges, components and rims of a mesh that may be open, and edits of its list of triangles: what
// repair and the separation of open sheets have in common.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// Two vertices, ascending.
using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// An edge of a triangle.
struct HalfEdge {
  Edge edge;
  std::uint32_t triangle;
  int corner;  ///< where it starts
  /// By edge, then by triangle.
  friend bool operator<(const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.edge, a.triangle, a.corner) < std::tie(b.edge, b.triangle, b.corner);
  }
};

/// The half-edges of all triangles, sorted by edge.
std::vector<HalfEdge> half_edges_of(const TriangleMesh& mesh);

/// Calls call(half-edges) for each edge.
template <class Call>
void each_edge(const std::vector<HalfEdge>& half_edges, const Call& call) {
  for (std::size_t i = 0, end = 0; i < half_edges.size(); i = end) {
    while (end < half_edges.size() && half_edges[end].edge == half_edges[i].edge) ++end;
    call(std::span(half_edges).subspan(i, end - i));
  }
}

/// Removes the triangles that are not kept, with their attributes.
void keep(TriangleMesh& mesh, const std::vector<char>& kept);

/// Reverses the orientation of a triangle; its normals turn outwards.
void flip(TriangleMesh& mesh, std::uint32_t t);

/// Drops triangles with a vertex twice. Among triangles with the same vertices it keeps one, of the
/// majority's orientation, or none where the orientations cancel. Returns the number dropped.
std::size_t drop_degenerate(TriangleMesh& mesh);

/// Connected components of triangles, across edges of two triangles.
struct Components {
  std::vector<std::uint32_t> of;  ///< per triangle
  std::uint32_t count = 0;
};

/// Orients neighbours alike; a component turns the smaller part of its triangles.
Components orient(TriangleMesh& mesh);

/// The rims of holes: loops of edges with one triangle, as the half-edges along them. A loop that
/// passes a vertex twice is divided in two.
std::vector<std::vector<HalfEdge>> rims_of(const TriangleMesh& mesh);

/// The vertices of a rim, in its order: the corners of the hole.
std::vector<std::uint32_t> polygon_of(const TriangleMesh& mesh, const std::vector<HalfEdge>& rim);

}  // namespace geo
