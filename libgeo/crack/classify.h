// Which parts of the strip lie in the material (§ 5.2's trimming), and in which order faces stand
// around an edge.
#pragma once

#include <span>
#include <vector>

#include "crack/arrangement.h"

namespace geo::crack {

/// A child at one of its edges.
struct Use {
  std::uint32_t element, child;
  std::uint8_t k;  ///< the edge from the child's k-th corner to the next
};

/// Children by edge; only edges that anything but their own element can have.
class EdgeTable {
 public:
  explicit EdgeTable(std::size_t points) : head_(points, ~0u) {}
  void reserve(std::size_t uses) { entries_.reserve(uses); }
  void add(Local u, Local v, const Use& use);
  /// Replaces `out` by the uses of edge uv, in the order in which they were added.
  void find(Local u, Local v, std::vector<Use>& out) const;

 private:
  struct Entry {
    Local high;
    std::uint32_t next;
    Use use;
  };
  std::vector<std::uint32_t> head_;  // by lower point
  std::vector<Entry> entries_;
};

/// A face at a directed edge u→v, for the order around it.
struct Member {
  std::uint32_t element;
  Local apex;
  bool forward;  ///< it runs u→v
};
Member member_at(const Arrangement& a, const Use& use, Local u);

/// Sign of angle(p) − angle(q) around u→v, counter-clockwise from `zero`, exactly.
int compare_around(const Arrangement& a, Local u, Local v, const Member& zero, const Member& p, const Member& q);

/// The edges of all faces of K in the arrangement, after splitting.
EdgeTable edges_of_complex(const Arrangement& arrangement);

/// The strip's parts (rows of arrangement.children, by their element) that lie in material and on
/// no face. Decided at the edges they share with K by the wedge they stand in, and flooded
/// elsewhere; a part that touches nothing is asked against the skin. Throws GeometryError when two
/// edges disagree.
struct Part {
  std::uint32_t element, child;
};
std::vector<Part> keep_inside(const Arrangement& arrangement, const Complex& complex, const EdgeTable& edges);

/// True when q is in the material (not in a cavity, not outside): exact parity along a line through
/// the index.
bool inside_material(const Complex& complex, const Vec3& q);

/// Fills the edit from the arrangement: removed faces, children, crack faces, vertices, and the
/// order around each edge that a crack face joins or that has three faces and more. `vertex`
/// receives the vertex of each local point in use.
ComplexEdit stitch(const Arrangement& arrangement, const Complex& complex, const EdgeTable& edges,
                   std::span<const Part> parts, std::int32_t crack, std::vector<VertexId>& vertex);

}  // namespace geo::crack
