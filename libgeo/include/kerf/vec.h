// Vectors, boxes and typed indices: the vocabulary that all modules share.
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

/// A 32-bit index of one kind of element. Kinds do not convert into each other: a vertex of the
/// crack complex cannot be passed where a node is expected.
template <class Tag>
struct Id {
  /// The value of an invalid id.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  /// The index itself.
  std::uint32_t value = none;

  /// An invalid id.
  constexpr Id() = default;
  /// The id with value v.
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  /// The id with value v, which must fit into 32 bits.
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  /// Whether the id refers to an element.
  constexpr bool valid() const { return value != none; }
  /// The value as a subscript of arrays.
  constexpr std::size_t index() const { return value; }
  /// Compares values; invalid ids come last.
  friend constexpr auto operator<=>(Id, Id) = default;
};

using VertexId = Id<struct VertexTag>;                ///< a vertex of the crack complex K (a "site")
using FaceId = Id<struct FaceTag>;                    ///< a face of the crack complex K
using SurfaceVertexId = Id<struct SurfaceVertexTag>;  ///< a vertex of the derived two-sided surface (a fan)
using NodeId = Id<struct NodeTag>;                    ///< a simulation node

}  // namespace geo

/// Hashes ids by their values.
template <class Tag>
struct std::hash<geo::Id<Tag>> {
  /// The hash of the value.
  std::size_t operator()(geo::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value); }
};

namespace geo {

using Vec2 = Eigen::Vector2d;                   ///< a point or direction in the plane
using Vec3 = Eigen::Vector3d;                   ///< a point or direction, in model units
using Mat3 = Eigen::Matrix3d;                   ///< a 3 × 3 matrix
using Triangle = std::array<std::uint32_t, 3>;  ///< three vertex indices, counter-clockwise from outside

/// The largest coordinate that files may contain. Beyond it, products of five differences, as in
/// predicates and measures, overflow.
constexpr double largest_coordinate = 1e60;
/// Whether all coordinates are finite and at most largest_coordinate in magnitude.
inline bool in_range(const Vec3& p) { return p.cwiseAbs().maxCoeff() <= largest_coordinate && p.allFinite(); }

/// A closed axis-aligned box; empty if default-constructed.
struct Box3 {
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());   ///< lower corner
  Vec3 hi = Vec3::Constant(-std::numeric_limits<double>::infinity());  ///< upper corner

  /// Extends the box to contain p.
  void add(const Vec3& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  /// Extends the box to contain b.
  void add(const Box3& b) {
    lo = lo.cwiseMin(b.lo);
    hi = hi.cwiseMax(b.hi);
  }
  /// Whether the box contains no point.
  bool empty() const { return (lo.array() > hi.array()).any(); }
  /// Whether the boxes have a common point; touching counts. An empty box meets none.
  bool meets(const Box3& b) const {
    return lo[0] <= b.hi[0] && b.lo[0] <= hi[0] && lo[1] <= b.hi[1] && b.lo[1] <= hi[1] && lo[2] <= b.hi[2] &&
           b.lo[2] <= hi[2];
  }
  /// The box extended by r on all sides.
  Box3 grown(double r) const { return {lo - Vec3::Constant(r), hi + Vec3::Constant(r)}; }
  /// Length of the diagonal; 0 if the box is empty.
  double diagonal() const { return empty() ? 0.0 : (hi - lo).norm(); }
  /// The centre. Precondition: not empty.
  Vec3 center() const { return 0.5 * (lo + hi); }
};

/// The bounding box of triangle abc.
inline Box3 box_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

/// The square of the distance between two points, always summed as (x² + y²) + z².
inline double squared_distance(const Vec3& p, const Vec3& q) {
  const double x = p.x() - q.x(), y = p.y() - q.y(), z = p.z() - q.z();
  return (x * x + y * y) + z * z;
}

}  // namespace geo
