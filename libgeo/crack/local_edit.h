// Local edits of K that preserve its topology: edge collapse, edge flip, edge division, vertex
// move.
//
// Radial orders around the edges that change follow from the old orders by combinatorics alone. The
// guard decides whether the new faces may be at their positions.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "crack/guard.h"
#include "surface/delta_sum.h"

namespace geo::crack {

/// An edit together with the volume that its faces sweep.
struct LocalEdit {
  ComplexEdit edit;
  std::vector<Family> families;            ///< one per new face: the face that it replaces
  std::vector<std::array<Vec3, 4>> swept;  ///< tetrahedra between old and new faces; no vertex may lie inside
};

/// Edge collapse: merges b into its neighbour a; the faces at edge ab vanish. Empty where the
/// topology would change (link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999).
std::optional<LocalEdit> collapse(const Complex& complex, VertexId b, VertexId a);

/// Edge flip: replaces edge k of f by the other diagonal of its two faces. Empty unless the faces
/// are of one crack and one source and oriented alike, and the diagonal is new.
std::optional<LocalEdit> flip(const Complex& complex, FaceId f, int k);

/// Divides edge ab and all its faces at p.
LocalEdit divide(const Complex& complex, VertexId a, VertexId b, const Vec3& p);

/// Moves v to p: replaces it by a new vertex with v's faces.
LocalEdit relocate(const Complex& complex, VertexId v, const Vec3& p);

/// True when no face turns over or crosses another one, and no vertex lies in the swept volume.
bool is_sound(const Complex& complex, LocalEdit& local);

/// Commits the edit if it is sound and K accepts it, and adds the changes to `sum`. Empty, K
/// unchanged, where it is refused.
std::optional<CrackDelta> try_commit(Complex& complex, LocalEdit& local, DeltaSum& sum);

}  // namespace geo::crack
