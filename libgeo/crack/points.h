// The points of an arrangement: explicit ones (doubles), and implicit ones (intersections of edges
// with planes) that are exact.
//
// An implicit point is stored as a double with an error bound, which decides nearly every
// predicate. Exact homogeneous coordinates are computed when a predicate needs them (compare M.
// Attene, "Indirect predicates for geometric constructions", 2020).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kerf/vec.h"

namespace geo::crack {

using PointIndex = std::uint32_t;     ///< index of a point of the arrangement
constexpr PointIndex no_point = ~0u;  ///< stands for none

/// Hash of a position: equal for equal points, both zeros being one.
std::uint64_t hash_of(const Vec3& p);

/// A list of explicit and implicit points with exact predicates. Not safe for use by several
/// threads at once, not even its const methods: exact coordinates are cached on demand.
class Points {
 public:
  /// No points.
  Points();
  ~Points();
  Points(const Points&) = delete;
  Points& operator=(const Points&) = delete;

  /// Adds an explicit point.
  PointIndex add(Vec3 p);
  /// Adds the intersection of segment ab with the plane of pqr. Precondition: a and b are strictly
  /// on opposite sides of the plane.
  PointIndex add_crossing(Vec3 a, Vec3 b, Vec3 p, Vec3 q, Vec3 r);
  /// Adds the intersection of lines ab and cd, which lie in one plane that is not parallel to
  /// `axis`.
  PointIndex add_crossing_in_plane(PointIndex a, PointIndex b, PointIndex c, PointIndex d, int axis);

  /// Reserves memory.
  void reserve(std::size_t count) {
    near_.reserve(count);
    error_.reserve(count);
    definition_.reserve(count);
    definitions_.reserve(count);
  }
  /// Number of points.
  std::size_t size() const { return near_.size(); }
  /// The double nearest to the point, or nearly so.
  const Vec3& operator[](PointIndex l) const { return near_[l]; }
  /// Bound of the error of each coordinate of that double; 0: the double is the point.
  double error(PointIndex l) const { return error_[l]; }

  /// Sign of det(b−a, c−a, d−a), as in geometry/predicates.h.
  int orient3d(PointIndex a, PointIndex b, PointIndex c, PointIndex d) const;
  /// Sign of the turn abc, projected along `axis` (0, 1, 2) to coordinates (axis + 1, axis + 2)
  /// mod 3: positive for counter-clockwise.
  int orient2d(PointIndex a, PointIndex b, PointIndex c, int axis) const;
  /// Sign of coordinate `axis` of a minus that of b.
  int compare(PointIndex a, PointIndex b, int axis) const;
  /// Whether both points coincide, exactly.
  bool coincide(PointIndex a, PointIndex b) const;
  /// Hash of the exact position: equal for points that coincide.
  std::uint64_t hash(PointIndex l) const;

 private:
  struct Exact;
  struct Definition {
    PointIndex point;
    std::array<Vec3, 5> of;  // a, b, p, q, r
  };
  const Exact& exact(PointIndex l) const;
  PointIndex append(Vec3 p, double error);
  void round(PointIndex l);

  std::vector<Vec3> near_;
  std::vector<double> error_;
  std::vector<std::uint32_t> definition_;  // index into definitions_, ~0u: none
  std::vector<Definition> definitions_;
  mutable std::vector<std::unique_ptr<Exact>> exact_;  // cache; one thread at a time, see above
};

}  // namespace geo::crack
