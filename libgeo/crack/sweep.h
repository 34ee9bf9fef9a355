// The splitting surface S_S (§ 5.1): the strip of triangles that a front sweeps in one step.
#pragma once

#include <span>
#include <vector>

#include "kerf/crack.h"

namespace geo {

/// Triangles between the old front (its contacts included) and its next position. What the old
/// front shares with K is shared by position to the bit, because contacts were frozen to doubles
/// when they were stored.
struct Strip {
  struct Triangle {
    std::array<std::uint32_t, 3> p;
    std::array<int, 3> segment{-1, -1, -1};  ///< of edge k (p[k] to p[k+1]): the new front's segment it lies on, or −1
  };
  std::vector<Vec3> points;
  std::vector<bool> carried;  ///< per point: it is on the old front and may not be moved
  std::vector<Triangle> triangles;
  std::vector<Vec3> next;  ///< the new front's points, as snapped
  /// Faces of K near triangle t: near[near_begin[t]..near_begin[t + 1]); filled by find_near().
  std::vector<FaceId> near;
  std::vector<std::uint32_t> near_begin;
};

/// Two triangles a segment, more where contacts divide it; standing points give one triangle,
/// standing segments none. Consecutive strips of a front are oriented alike. Triangles without area
/// are left out.
Strip sweep(const FrontState& front, std::span<const Vec3> next);

/// Any triangles as a strip without fronts. Points at one place become one; triangles without area
/// are left out.
Strip strip_of(std::span<const Vec3> points, std::span<const geo::Triangle> triangles);

/// Fills `near`: the faces of K whose boxes are within `reach` of a triangle's box and not clear of
/// its plane.
void find_near(Strip& strip, const Complex& complex, double reach);

/// Moves what the strip can move onto vertices of K that are closer than `reach`: its new points to
/// the vertex; where a vertex is nearly on an edge or inside of a triangle, the strip is divided
/// there. Returns how many were snapped. Leaves `near` filled.
std::size_t snap_to_vertices(Strip& strip, const Complex& complex, double reach);

}  // namespace geo
