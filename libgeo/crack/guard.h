// The guard: checks that an edit of K is still valid once its coordinates are rounded to doubles.
//
// Decisions about the edit are exact; its new points are then rounded. Rounding may turn small
// faces over or make them cross. The guard finds such faults before the commit, and repairs them by
// displacing rounded points by a few ulps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "crack/pause.h"
#include "kerf/complex.h"

namespace geo {

/// The position of a vertex after an edit of `complex`.
inline const Vec3& point_after(const Complex& complex, const ComplexEdit& edit, VertexId v) {
  return v.value < complex.vertex_count() ? complex.point(v) : edit.new_vertices[v.value - complex.vertex_count()];
}

/// New faces that divide one triangle and therefore lie in its plane, but for rounding.
struct Family {
  std::array<Vec3, 3> plane;     ///< the triangle's corners
  std::uint32_t first, end;      ///< edit.new_faces[first..end)
  std::span<const FaceId> near;  ///< faces of K that may be near, if they are known
  bool near_known;               ///< else they are looked up
  bool whole;                    ///< they cover the triangle, or no child that is left out is turned over
};

/// A piece of a front's line that leaves the material at a vertex; see exits.h.
struct FrontExit {
  VertexId from;                 ///< where the line leaves the material
  Vec3 to;                       ///< the end of the piece outside
  VertexId at;                   ///< the vertex at `to`, where the line comes back; else invalid
  std::span<const FaceId> near;  ///< faces of K that may be near
};

/// Facts about an edit that the guard needs in addition to the edit itself.
struct GuardContext {
  std::span<const Family> families;  ///< list every new face once, in order
  /// Per new vertex: whether rounding moved it. Faces without such a vertex are as exact decisions
  /// left them and are not tested. Empty: all are tested.
  std::span<const std::uint8_t> moved{};
  /// Least distance between features of cracks that do not touch, model units. It applies to exact
  /// faces, too: an earlier step may have rounded what is near them, and no later step could round
  /// a gap of a few ulps. 0: no limit.
  double clearance = 0;
  std::span<const FrontExit> exits{};  ///< lines of the front outside the material
};

/// The reason why an edit is invalid.
struct Fault {
  std::string what;                  ///< empty: no fault
  std::vector<std::uint32_t> faces;  ///< indices into edit.new_faces of the faces concerned
  /// True when there is a fault.
  explicit operator bool() const { return !what.empty(); }
};

/// Checks an edit against K as it is. In order: each new face has an area and the orientation of
/// its family's triangle; no two vertices coincide; faces around edges are in the radial order
/// listed; no new face crosses another one or is nearer than the clearance; exits stay outside.
/// Exact, except for the clearance. Returns the first fault, none for a valid edit. Cost follows
/// the edit. `pause` may throw.
Fault find_fault(const Complex& complex, const ComplexEdit& edit, const GuardContext& context,
                 const crack::Pause& pause = {});

/// Tries to remove faults by displacing rounded points, from 1 ulp up to 2¹⁵. Returns the remaining
/// fault, none for a valid edit. Increments `repairs` when all faults were removed.
/// `pause` may throw.
Fault snap_repair(const Complex& complex, ComplexEdit& edit, const GuardContext& context, std::size_t& repairs,
                  const crack::Pause& pause = {});

}  // namespace geo
