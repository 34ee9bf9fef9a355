// The strip S_S (§ 5.1): the triangles that a front sweeps in one step.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/crack.h"

namespace geo {

/// Triangles between the front F_i, its contacts included, and F_(i+1). Vertices that the old front
/// shares with K coincide exactly: contacts were rounded to doubles when they were stored.
struct Strip {
  struct Triangle {
    std::array<std::uint32_t, 3> p;  ///< indices into points
    /// Per edge k (p[k] to p[k+1]): the segment of the new front on which it lies; −1: none.
    std::array<int, 3> segment{-1, -1, -1};
  };
  std::vector<Vec3> points;
  std::vector<bool> fixed;  ///< per point: it is on the old front, or snapped, and must not move
  std::vector<Triangle> triangles;
  /// Edges on the line of an old front that has moved, as indices into points: the last strip ends
  /// there, so they are not divided.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> old_front;
  std::vector<Vec3> new_front;  ///< the points of F_(i+1), as snapped
  /// Faces of K near triangle t: near[near_begin[t]..near_begin[t + 1]); see find_near().
  std::vector<FaceId> near;
  std::vector<std::uint32_t> near_begin;

  /// Whether the edge between two positions is on the line of an old front that has moved. The last
  /// strip ends there, in K or in the air: this one would come off it if the edge were divided.
  bool is_on_old_front(const Vec3& a, const Vec3& b) const;
};

/// The strip of a step: two triangles per segment, more where contacts divide it; a standing point
/// gives one triangle, a standing segment none. Consecutive strips of a front are oriented alike.
/// Degenerate triangles are left out.
Strip sweep(const FrontState& front, std::span<const Vec3> next);

/// Any triangles as a strip without fronts. Equal points become one; degenerate triangles are left
/// out.
Strip strip_of(std::span<const Vec3> points, std::span<const geo::Triangle> triangles);

/// Fills `near` as Complex::faces_near_triangle() does, for each triangle of the strip. `reach`:
/// model units.
void find_near(Strip& strip, const Complex& complex, double reach);

/// Snaps the strip to vertices of K closer than `reach` (model units): a free point moves to the
/// vertex; a triangle near a vertex is divided there, and an edge that is not on the old front.
/// Returns how many vertices it snapped to. Fills `near`.
std::size_t snap_to_vertices(Strip& strip, const Complex& complex, double reach);

}  // namespace geo
