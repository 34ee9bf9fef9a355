// The front of a crack that grows by itself: what is kept at its points, and how it goes on.
#pragma once

#include "kerf/body.h"
#include "kerf/run.h"
#include "simulation/fracture_tip.h"

namespace geo {

/// The frame at point i of a front: at, ahead and normal.
TipFrame tip_frame(const GrowingFront& front, std::size_t i);

/// A front as begin_front() or a blade leaves it, with its normals. Throws InputError unless there
/// is one a point.
GrowingFront growing(FrontState front, std::vector<Vec3> normals);

/// Where the points of a front go: entry k starts from point from[k] (a point may be there several
/// times: then new ones begin at it) and goes to next[k]; equal neighbours become one.
struct FrontPlan {
  std::vector<std::uint32_t> from;
  std::vector<Vec3> next;
  std::vector<std::uint8_t> ended;
};

/// Live points go by `step[i]` (≥ 0) along `direction[i]` (unit), to a surface where one is near:
/// what is thinner than half of `spacing` beyond parts with it, and the front sticks out by a
/// seventh of it. Where the front ends at a surface it slides along it. Points are put in and taken
/// out so that they stay about as far apart as 0.7 `spacing`.
FrontPlan plan_front(const Complex& complex, const GrowingFront& front, std::span<const double> step,
                     std::span<const Vec3> direction, double spacing);

/// The front with the points that a plan starts from: what split() is to be called with, and
/// `plan.next`.
FrontState depart(const GrowingFront& front, const FrontPlan& plan);

/// What becomes of a front that `moved` from `before` as planned: parts of it that are inside, one
/// front each; none when all of it has come to surfaces.
std::vector<GrowingFront> arrive(const GrowingFront& before, const FrontPlan& plan, FrontState moved,
                                 std::span<const Vec3> direction);

/// A closed front about `center` in the plane of `normal`, of no size, and the plan that opens it
/// to `radius`, through the skin where that is near.
std::pair<GrowingFront, FrontPlan> plan_flaw(const Complex& complex, const Vec3& center, const Vec3& normal,
                                             double radius, std::int32_t crack);

}  // namespace geo
