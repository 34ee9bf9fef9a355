// Triangulates one face alone, constrained to what it shares with others (§ 5.2).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "crack/points.h"

namespace geo::crack {

/// What an edge of a child is: part of the face's own edge 0, 1 or 2, of a constraint, or nothing
/// but a diagonal.
enum EdgeKind : std::uint8_t { edge_constraint = 3, edge_diagonal = 4 };

struct Child {
  std::array<Local, 3> v;            ///< oriented as the face is
  std::array<std::uint8_t, 3> edge;  ///< kind of the edge from v[k] to v[k+1]
};

/// A point of a face; bit k of `edges` is set when it lies on the face's edge k.
struct Mark {
  Local point;
  std::uint8_t edges;
};

/// The bits of corner k: it lies on the edges k and k − 1.
inline std::uint8_t corner_bits(int k) { return static_cast<std::uint8_t>(1 << k | 1 << (k + 2) % 3); }

/// Constrained Delaunay as far as rounding allows it: exact where it decides what is where,
/// approximate in which of two diagonals is the better one. Keeps its memory between calls.
class Triangulator {
 public:
  explicit Triangulator(Points& points) : points_(points) {}

  /// Called with a new point where two constraints cross; returns the row under which that place is
  /// known.
  using Known = std::function<Local(Local)>;

  /// `marks`: points other than the corners, each once. Appends the children to `out`. Throws
  /// GeometryError when the face has no area, when two rows are at one place, or when constraints
  /// cross and `known` is empty.
  void triangulate(const std::array<Local, 3>& corner, std::span<const Mark> marks,
                   std::span<const std::pair<Local, Local>> constraints, const Known& known, std::vector<Child>& out);

 private:
  struct Tri {
    int v[3], n[3];  // n[k]: across the edge from v[k] to v[k+1]; −1: none
    std::uint8_t e[3];
  };
  int add_vertex(Local l, std::uint8_t edges);
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
  void constrain(int a, int b, const Known& known);
  void improve();
  void straighten();

  Points& points_;
  int axis_ = 0, sign_ = 1;
  std::vector<Local> local_;         // per vertex
  std::vector<std::uint8_t> edges_;  // per vertex
  std::vector<int> at_;              // per vertex: a triangle that has it
  std::vector<int> row_;             // per point: its vertex, −1
  std::vector<Tri> tri_;
};

/// As projection_axis(), for three points that are doubles, as corners of elements are.
std::pair<int, int> view_of(const Points& points, const std::array<Local, 3>& corner);

}  // namespace geo::crack
