// The front of a crack that grows by itself: what is kept at its points, and how it goes on.
#pragma once

#include "kerf/body.h"
#include "simulation/fracture_tip.h"

namespace geo {

/// A front with a frame at each of its points. Ahead of point i is tangent × normal, the tangent along the points.
struct GrowingFront {
  FrontState front;
  std::vector<Vec3> normal;         ///< per point: of the crack there, unit, material coordinates
  std::vector<double> owed;         ///< per point: how far it should have come but has not, model units
  std::vector<std::uint8_t> ended;  ///< per point: 1 where it has come to a surface, the skin's or another crack's
  double length = 0;                ///< how far the fastest point has come since the front began or divided

  std::size_t size() const { return front.points.size(); }
  /// Inside the material, and on its way.
  bool live(std::size_t i) const { return !ended[i] && front.points[i].id.valid(); }
  TipFrame frame(std::size_t i) const;
};

/// A front as begin_front() or a blade leaves it, with its normals. Throws InputError unless there is one a point.
GrowingFront growing(FrontState front, std::vector<Vec3> normals);

/// Where the points of a front go: entry k starts from point from[k] (a point may be there several times: then new ones
/// begin at it) and goes to next[k]; equal neighbours become one.
struct FrontPlan {
  std::vector<std::uint32_t> from;
  std::vector<Vec3> next;
  std::vector<std::uint8_t> ended;
};

/// Live points go by `step[i]` (≥ 0) along `direction[i]` (unit), to a surface where one is near: what is thinner than
/// half of `spacing` beyond parts with it, and the front sticks out by a seventh of it. Where the front ends at a
/// surface it slides along it. Points are put in and taken out so that they stay about as far apart as 0.7 `spacing`.
FrontPlan plan_front(const Complex& complex, const GrowingFront& front, std::span<const double> step,
                     std::span<const Vec3> direction, double spacing);

/// The front with the points that a plan starts from: what split() is to be called with, and `plan.next`.
FrontState depart(const GrowingFront& front, const FrontPlan& plan);

/// What becomes of a front that `moved` from `before` as planned: parts of it that are inside, one front each; none
/// when all of it has come to surfaces.
std::vector<GrowingFront> arrive(const GrowingFront& before, const FrontPlan& plan, FrontState moved,
                                 std::span<const Vec3> direction);

/// A closed front about `center` in the plane of `normal`, of no size, and the plan that opens it to `radius`, through
/// the skin where that is near.
std::pair<GrowingFront, FrontPlan> plan_flaw(const Complex& complex, const Vec3& center, const Vec3& normal,
                                             double radius, std::int32_t crack);

}  // namespace geo
