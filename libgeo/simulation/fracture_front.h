// Fronts of cracks that grow by stress: plan of a step, and the fronts after it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/body.h"
#include "kerf/simulation.h"
#include "simulation/fracture_tip.h"

namespace geo {

/// The frame at point i of a front.
TipFrame tip_frame(const GrowingFront& front, std::size_t i);

/// A growing front from one that begin_front() or a blade leaves, with a unit crack normal for each
/// point, material coordinates. Throws InputError where their numbers differ.
GrowingFront growing(FrontState front, std::vector<Vec3> normals);

/// The growing front of a crack that a front has cut by its steps; crack normals are across its
/// last step, from `before` to `after`, which have the same points. Empty where it has not moved,
/// or no point is in the material.
std::optional<GrowingFront> growing_after(const FrontState& before, FrontState after);

/// Where a front is now; at the origin where none of its points is in the material.
CrackTip tip_of(const GrowingFront& front);

/// Next positions of a front. Entry k starts at point from[k] of the front and moves to next[k].
/// Several entries may start at one point: points are inserted there. Equal neighbours are merged
/// after the step.
struct FrontPlan {
  std::vector<std::uint32_t> from;
  std::vector<Vec3> next;
  std::vector<std::uint8_t> ended;  ///< 1 where the entry reaches a surface
};

/// Plans the growth of a front. Live points move by `step[i]` (≥ 0) along the unit vector
/// `direction[i]`. Where a surface is within half of `spacing` beyond, the front cuts through to it
/// and sticks out by a seventh of `spacing`. The ends of the front slide along the surface. Points
/// are inserted and merged so that their distances stay about 0.7 `spacing`.
FrontPlan plan_front(const Complex& complex, const GrowingFront& front, std::span<const double> step,
                     std::span<const Vec3> direction, double spacing);

/// The front with the points that a plan starts from: the front to be passed to split(), with
/// `plan.next` as its next positions.
FrontState with_planned_points(const GrowingFront& front, const FrontPlan& plan);

/// The fronts after a step that moved `before` to `moved` by a plan: one for each part inside the
/// material, none where all of it has reached surfaces.
std::vector<GrowingFront> fronts_after(const GrowingFront& before, const FrontPlan& plan, const FrontState& moved,
                                       std::span<const Vec3> direction);

/// A new penny-shaped crack: a closed front of size zero at `center`, and the plan that opens it to
/// `radius`, model units, in the plane of `normal`. It cuts through the surface where that is
/// within 1.5 radii. `crack`: its number, which no other crack has.
std::pair<GrowingFront, FrontPlan> plan_flaw(const Complex& complex, const Vec3& center, const Vec3& normal,
                                             double radius, std::int32_t crack);

}  // namespace geo
