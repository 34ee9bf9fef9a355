// Triangulates one face alone, constrained to its intersections with other faces (§ 5.2).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "crack/points.h"

namespace geo::crack {

/// Kinds of a child's edge: part of the face's own edge 0, 1 or 2, part of a constraint, or a
/// diagonal.
enum EdgeKind : std::uint8_t { edge_constraint = 3, edge_diagonal = 4 };
/// Whether an edge of this kind is part of the face's own edges.
constexpr bool on_face_edge(std::uint8_t kind) { return kind < edge_constraint; }

/// A triangle that a face is divided into.
struct Child {
  std::array<PointIndex, 3> v;       ///< oriented as the face is
  std::array<std::uint8_t, 3> edge;  ///< kind of the edge from v[k] to v[k+1]
};

/// A point in or on a face other than its corners. Bit k of `edges` is set when it lies on edge k.
struct SteinerPoint {
  PointIndex point;
  std::uint8_t edges;
};

/// The edge bits of corner k: it lies on the edges k and k − 1.
inline std::uint8_t corner_bits(int k) { return static_cast<std::uint8_t>(1 << k | 1 << (k + 2) % 3); }

/// Constrained triangulation, Delaunay as far as rounding permits. Its topology is decided exactly;
/// the choice between two diagonals is approximate. Keeps its memory between calls.
class Triangulator {
 public:
  /// Triangulates faces between these points, and adds points where constraints cross.
  explicit Triangulator(Points& points) : points_(points) {}

  /// Called with the new point at the crossing of two constraints. Returns the index of the known
  /// point at the same position, or the argument for a new position.
  using Canonicalize = std::function<PointIndex(PointIndex)>;

  /// Appends the children of a face to `out`. `steiner`: its points other than the corners, each
  /// once; `constraints`: segments between its points. Throws GeometryError for a face without
  /// area, for points that coincide or lie outside, for constraints that leave the face, meet a
  /// vertex unlisted, or cross when `canonicalize` is empty.
  void triangulate(const std::array<PointIndex, 3>& corner, std::span<const SteinerPoint> steiner,
                   std::span<const std::pair<PointIndex, PointIndex>> constraints, const Canonicalize& canonicalize,
                   std::vector<Child>& out);

 private:
  struct Tri {
    int v[3], n[3];  // n[k]: neighbour across the edge from v[k] to v[k+1]; −1: none
    int e[3];        // EdgeKind, but for constraints first_line + the number of theirs
  };
  // A constraint as it was given. Predicates take its own ends, not the crossings on it, as
  // crossings of crossings would have ever more digits.
  struct Line {
    int a, b;  // vertices
  };
  static constexpr int first_line = edge_diagonal + 1;
  // The first triangle at a vertex that a segment enters, or a vertex on the segment.
  struct Departure {
    int through = -1, edge = -1, ahead = -1;
  };
  // The edges that a segment crosses, as (right, left) vertices, up to the next vertex on it.
  struct Corridor {
    std::vector<std::pair<int, int>> crossed;
    int end = -1;
  };
  int add_vertex(PointIndex l, std::uint8_t edges);
  int turn(int a, int b, int c) const;
  int rounded_turn(int a, int b, int c) const;
  void turn_to(int t, int edge);
  void relink(int t, int from, int to);
  void split_edge(int t, int edge, int p);
  void split_face(int t, int p);
  void flip(int t, int edge);
  bool may_flip(int t, int edge, int& other, int& apex);
  template <class Visit>
  void around(int a, const Visit& visit) const;
  std::pair<int, int> find_edge(int a, int b) const;
  void insert(int p);
  void insert_edge_points(const std::array<PointIndex, 3>& corner, std::span<const SteinerPoint> steiner, int k);
  void constrain(int a, int b, const Canonicalize& canonicalize);
  int side(int v) const { return turn(lines_.back().a, lines_.back().b, v); }
  bool mark_constraint(int a, int b);
  bool is_ahead(int a, int b, int v) const;
  Departure leave(int a, int b) const;
  Corridor walk(int b, const Departure& from, const Canonicalize& canonicalize);
  int split_at_crossing(int t, int edge, const Canonicalize& canonicalize);
  void clear_corridor(int a, int end, std::vector<std::pair<int, int>>& crossed);
  void improve();
  void unflip_rounded();

  Points& points_;
  int axis_ = 0, sign_ = 1;
  std::vector<PointIndex> local_;    // per vertex: its point
  std::vector<std::uint8_t> edges_;  // per vertex: bits of the face's edges
  std::vector<int> at_;              // per vertex: a triangle that has it
  std::vector<int> vertex_;          // per point: its vertex, −1
  std::vector<Tri> tri_;
  std::vector<Line> lines_;        // constraints so far; the last one is at hand
  std::vector<PointIndex> chain_;  // points on the edge at hand
};

/// projection_axis() of three explicit points, as corners of elements are: the dominant axis of the
/// normal, and the sign of orient2d along it (0: no area).
std::pair<int, int> projection_of(const Points& points, const std::array<PointIndex, 3>& corner);

}  // namespace geo::crack
