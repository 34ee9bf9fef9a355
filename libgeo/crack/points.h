// The points of one step's arrangement: doubles, and points that edges and planes of doubles define
// exactly.
//
// A defined point is kept as a double with a bound of its error, which settles nearly every
// predicate; its exact coordinates are worked out only when one asks for them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kerf/vec.h"

namespace geo::crack {

using Local = std::uint32_t;  ///< row of a point of the arrangement
constexpr Local no_local = ~0u;

/// Equal for equal points, both zeros being one.
std::uint64_t hash_of(const Vec3& p);

class Points {
 public:
  Points();
  ~Points();
  Points(const Points&) = delete;
  Points& operator=(const Points&) = delete;

  Local add(Vec3 p);
  /// Where segment ab crosses the plane of pqr; a and b are strictly on opposite sides of it.
  Local add_crossing(Vec3 a, Vec3 b, Vec3 p, Vec3 q, Vec3 r);
  /// Where the lines ab and cd, which lie in one plane that is not parallel to `axis`, cross.
  Local add_crossing_in_plane(Local a, Local b, Local c, Local d, int axis);

  void reserve(std::size_t count) {
    near_.reserve(count), error_.reserve(count), definition_.reserve(count), definitions_.reserve(count);
  }
  std::size_t size() const { return near_.size(); }
  const Vec3& operator[](Local l) const { return near_[l]; }  ///< the double that stands for it
  double error(Local l) const { return error_[l]; }           ///< of each of its coordinates; 0: it is that double

  /// Sign of det(b−a, c−a, d−a) as in geometry/predicates.h.
  int orient3d(Local a, Local b, Local c, Local d) const;
  /// Sign of the turn abc seen against `axis` (0, 1, 2), counter-clockwise positive in the two axes
  /// that follow it.
  int orient2d(Local a, Local b, Local c, int axis) const;
  /// Sign of coordinate `axis` of a minus that of b.
  int compare(Local a, Local b, int axis) const;
  bool same_place(Local a, Local b) const;
  /// Equal for points at the same place.
  std::uint64_t hash(Local l) const;

 private:
  struct Exact;
  struct Definition {
    Local point;
    std::array<Vec3, 5> of;  // a, b, p, q, r
  };
  const Exact& exact(Local l) const;
  Local append(Vec3 p, double error);
  void round(Local l);

  std::vector<Vec3> near_;
  std::vector<double> error_;
  std::vector<std::uint32_t> definition_;  // row of definitions_, ~0u: none
  std::vector<Definition> definitions_;
  mutable std::vector<std::unique_ptr<Exact>> exact_;
};

}  // namespace geo::crack
