// Exact predicates without filters, for the cases that those of geometry/predicates.h leave open.
// There are two sets of them: CGAL's, and Kerf's own on whole numbers, for a core without CGAL.
#pragma once

#include <array>
#include <span>

#include "kerf/vec.h"

namespace geo {

/// Exact predicates. Coordinates are any finite doubles.
struct ExactPredicates {
  /// As orient3d() of geometry/predicates.h.
  int (*orient3d)(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  /// As orient2d() there, of points in the plane.
  int (*orient2d)(const Vec2& a, const Vec2& b, const Vec2& c);
  /// As collinear() there.
  bool (*collinear)(const Vec3& a, const Vec3& b, const Vec3& c);
  /// As coplanar_side() there.
  int (*coplanar_side)(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  /// Whether p lies on the closed segment ab, a ≠ b.
  bool (*on_segment)(const Vec3& a, const Vec3& b, const Vec3& p);
  /// Whether p lies on the closed triangle abc, which has an area.
  bool (*on_triangle)(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);
  /// Whether the closed segments pq and rs meet, p ≠ q and r ≠ s.
  bool (*segments_meet)(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s);
  /// Whether the closed segment pq, p ≠ q, meets the closed triangle abc, which has an area.
  bool (*segment_meets_triangle)(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);
  /// Whether two closed triangles, which have areas, meet.
  bool (*triangles_meet)(const Vec3 (&s)[3], const Vec3 (&t)[3]);
  /// As volume_sign() of geometry/predicates.h.
  int (*volume_sign)(std::span<const std::array<Vec3, 3>> triangles);
};

extern const ExactPredicates exact_by_cgal;      ///< CGAL's; not in the core
extern const ExactPredicates exact_by_integers;  ///< Kerf's own

}  // namespace geo
