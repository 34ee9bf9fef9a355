// Distinct integer ids: a vertex of the crack complex cannot be passed where a node is meant.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products: declared in Core, defined there
#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace geo {

/// A 32-bit index that only converts to other types by `.value`. Default-constructed it is invalid.
template <class Tag>
struct Id {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = none;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  constexpr bool valid() const { return value != none; }
  constexpr std::size_t index() const { return value; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using VertexId = Id<struct VertexTag>;                ///< a vertex of the crack complex K (a "site")
using FaceId = Id<struct FaceTag>;                    ///< a face of the crack complex K
using SurfaceVertexId = Id<struct SurfaceVertexTag>;  ///< a vertex of the derived two-sided surface (a fan)
using NodeId = Id<struct NodeTag>;                    ///< a simulation node

}  // namespace geo

template <class Tag>
struct std::hash<geo::Id<Tag>> {
  std::size_t operator()(geo::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value); }
};

// ----
// Vectors, boxes: the few words of linear algebra that every room shares.

namespace geo {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;  ///< a point or direction, in model units
using Mat3 = Eigen::Matrix3d;
using Triangle = std::array<std::uint32_t, 3>;  ///< three vertex rows, counter-clockwise from outside

/// Where files may put points: further out a product of five differences, as predicates and measures have, overflows.
constexpr double largest_coordinate = 1e60;
inline bool in_range(const Vec3& p) { return p.cwiseAbs().maxCoeff() <= largest_coordinate && p.allFinite(); }

/// Axis-aligned closed box. Default-constructed it is empty.
struct Box3 {
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 hi = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) { lo = lo.cwiseMin(p), hi = hi.cwiseMax(p); }
  void add(const Box3& b) { lo = lo.cwiseMin(b.lo), hi = hi.cwiseMax(b.hi); }
  bool empty() const { return (lo.array() > hi.array()).any(); }
  bool meets(const Box3& b) const {
    return lo[0] <= b.hi[0] && b.lo[0] <= hi[0] && lo[1] <= b.hi[1] && b.lo[1] <= hi[1] && lo[2] <= b.hi[2] &&
           b.lo[2] <= hi[2];
  }
  Box3 grown(double r) const { return {lo - Vec3::Constant(r), hi + Vec3::Constant(r)}; }
  double diagonal() const { return empty() ? 0.0 : (hi - lo).norm(); }
  Vec3 center() const { return 0.5 * (lo + hi); }
};

inline Box3 box_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

}  // namespace geo
