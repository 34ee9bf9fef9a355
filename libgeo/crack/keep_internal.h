// Which parts of the strip lie in the material (§ 5.2's trimming), and in which order faces stand around an edge.
#pragma once

#include <vector>

#include "crack/arrangement_internal.h"

namespace geo::crack {

/// A child of a strip element.
struct Part {
  std::size_t element;
  std::array<Local, 3> corner;
};

/// A child of a face of K (or a whole one) at an edge.
struct Occupant {
  std::size_t element;
  std::uint32_t child;
};
using EdgeMap = std::unordered_map<std::uint64_t, std::vector<Occupant>>;

/// Sign of angle(p) − angle(q) around u→v, counter-clockwise from `zero`, exactly.
int compare_exact(const Arrangement& a, Local u, Local v, Local zero, Local p, Local q);

/// The edges of all faces of K in the arrangement, after splitting.
EdgeMap edges_of_complex(const Arrangement& arrangement);

/// The strip's parts that lie in material and on no face. Decided at the edges they share with K by the wedge they stand
/// in, and flooded elsewhere; a part that touches nothing is asked against the skin. Throws GeometryError when two
/// edges disagree.
std::vector<Part> keep_inside(const Arrangement& arrangement, const Complex& complex, const EdgeMap& edges);

/// True when q is in the material (not in a cavity, not outside): exact parity along a line through the index.
bool inside_material(const Complex& complex, const Vec3& q);

/// Fills the edit from the arrangement: removed faces, children, crack faces, vertices, and the order around each edge
/// that a crack face joins or that has three faces and more. `vertex` receives the vertex of each local point in use.
ComplexEdit stitch(Arrangement& arrangement, const Complex& complex, const EdgeMap& edges, const std::vector<Part>& parts,
                   std::int32_t crack, std::vector<VertexId>& vertex);

}  // namespace geo::crack
