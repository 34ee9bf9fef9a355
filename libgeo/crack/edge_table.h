// Edges of an arrangement: which children use them, and in which radial order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crack/arrangement.h"

namespace geo::crack {

/// A child at one of its edges (an edge-use in Weiler's terms).
struct EdgeUse {
  std::uint32_t element, child;  ///< indices into Arrangement::elements and Arrangement::children
  std::uint8_t k;                ///< the edge from the child's k-th corner to the next
};

/// Edge-uses by edge. edges_of_complex() leaves out diagonals inside an element, which no other
/// element has; other tables may hold them.
class EdgeTable {
 public:
  /// An empty table for edges between this many points.
  explicit EdgeTable(std::size_t points) : first_(points + 1, 0) {}
  /// Reserves memory.
  void reserve(std::size_t uses) { added_.reserve(uses); }
  /// Adds a use of edge uv.
  void add(PointIndex u, PointIndex v, const EdgeUse& use);
  /// Sorts the uses by edge. Must be called once, after the last add() and before the first find().
  void sort();
  /// Replaces `out` by the uses of edge uv, in the order in which they were added.
  void find(PointIndex u, PointIndex v, std::vector<EdgeUse>& out) const;

 private:
  struct Entry {
    PointIndex low, high;
    EdgeUse use;
  };
  std::vector<Entry> added_, sorted_;  // sorted_: by lower point, as added
  std::vector<std::uint32_t> first_;   // by lower point: its first entry in sorted_
};

/// The edges of all faces of K in the arrangement, after splitting.
EdgeTable edges_of_complex(const Arrangement& arrangement);

/// A face at a directed edge u→v, for the radial order around that edge.
struct RadialFace {
  std::uint32_t element;  ///< index into Arrangement::elements; its plane is the face's
  PointIndex apex;        ///< the corner of the child opposite to the edge
  bool forward;           ///< its boundary runs u→v
};
/// The child of an edge-use as seen from the edge's end u.
RadialFace radial_face(const Arrangement& a, const EdgeUse& use, PointIndex u);

/// True when face w lies in the half-plane of `zero` around u→v. Exact.
bool lies_on(const Arrangement& a, PointIndex u, PointIndex v, const RadialFace& zero, const RadialFace& w);
/// Sign of angle(p) − angle(q) around u→v, angles in [0, 2π) counter-clockwise from `zero`. Exact.
int compare_around(const Arrangement& a, PointIndex u, PointIndex v, const RadialFace& zero, const RadialFace& p,
                   const RadialFace& q);

}  // namespace geo::crack
