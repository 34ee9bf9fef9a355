// Small edits of K that keep its topology: an edge collapsed, flipped or divided, a vertex moved.
//
// The radial order around the edges that change follows from the orders that were there, by
// combinatorics alone; whether the new faces may be where they are is the guard's question.
#pragma once

#include <optional>
#include <vector>

#include "crack/guard.h"
#include "surface/delta_sum.h"

namespace geo::crack {

struct LocalEdit {
  ComplexEdit edit;
  std::vector<Family> families;            ///< one a new face: the face that it replaces
  std::vector<std::array<Vec3, 4>> swept;  ///< tetrahedra that faces pass through; nothing else may be in them
};

/// Moves b into a, its neighbour: the faces that have both go. Empty where that would change the
/// topology (the links of a and b share more than that of ab; Dey, Edelsbrunner, Guha and Nekhayev
/// 1999).
std::optional<LocalEdit> collapse(const Complex& complex, VertexId b, VertexId a);

/// Exchanges edge k of f for the other diagonal of its two faces. Empty unless these are of one
/// crack and one source, oriented alike, and the diagonal is new.
std::optional<LocalEdit> flip(const Complex& complex, FaceId f, int k);

/// Divides edge ab and all its faces at p.
LocalEdit divide(const Complex& complex, VertexId a, VertexId b, const Vec3& p);

/// Moves v to p: a new vertex with v's faces.
LocalEdit relocate(const Complex& complex, VertexId v, const Vec3& p);

/// True when nothing speaks against it: no face turns over, crosses another or leaves something
/// enclosed behind it.
bool is_sound(const Complex& complex, LocalEdit& local);

/// Makes the edit if it is sound and K takes it, and adds what changed to `sum`; empty, K
/// unchanged, where it is not.
std::optional<CrackDelta> carry_out(Complex& complex, LocalEdit& local, DeltaSum& sum);

}  // namespace geo::crack
