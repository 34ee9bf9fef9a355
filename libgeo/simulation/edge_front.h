// Fronts that a blade's edge leaves in the material, with the edge parameter of their points
// (§ 5.1).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/crack.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"

namespace geo {

/// The shortest segment and the shortest way of a front, in node spacings. A sheet nearer than that
/// is not distinguished from the front.
constexpr double resolved_by_front = 0.05;
/// The distance from a sheet of its own blade within which an edge is beside it, in node spacings:
/// it is in that cut, goes on from it, or moves back along it.
constexpr double beside_own_sheet = 0.25;

/// A point of a blade's edge that was mapped into the material.
struct EdgePoint {
  double at = 0;  ///< edge parameter: i + t lies between the blade's points i and i + 1
  Vec3 material;
  double spacing = 0;  ///< of the nodes there, model units
  NodeId node;         ///< the nearest in the world; invalid: none is near
};

/// A new front at the given points, at least two. `crack`: number of the crack that it makes, > 0;
/// `name`: of the blade.
EdgeFront begin_edge(std::span<const EdgePoint> points, std::int32_t crack, const std::string& name,
                     bool closed = false);

/// The point nearest to an edge parameter. `points`: not empty.
const EdgePoint& nearest(std::span<const EdgePoint> points, double at);

/// The place of an edge parameter on a blade, in the blade's coordinates.
Vec3 place_on(const Blade& blade, double at);
/// The direction of the blade's edge there, in its own coordinates, of any length.
Vec3 direction_on(const Blade& blade, double at);
/// The place of an edge parameter on the front that has it, between the front's points; nothing
/// where none of the fronts does.
std::optional<Vec3> place_on(std::span<const EdgeFront> fronts, double at);

/// Upsampling: the front with a copy of the nearest point for each parameter of `next` that it
/// lacks. `to` receives the next position of every point; points whose parameter `next` lacks move
/// to that of the nearest one (downsampling). Both are ascending in the parameter.
EdgeFront refined(const EdgeFront& edge, std::span<const EdgePoint> next, std::vector<Vec3>& to);
/// Whether an edge rests: each of its points is within a twentieth of a node spacing of the nearest
/// point of the front. In a body that trembles it would cut slivers off.
bool rests(const EdgeFront& edge, std::span<const EdgePoint> next);
/// The same where some points stay because they would go back: each other one is that near.
/// `mapped`: where the edge is; `spacing`: of the nodes there; `to`: next positions; each for all
/// points of the front.
bool rests(const FrontState& front, std::span<const Vec3> mapped, std::span<const double> spacing,
           std::span<const Vec3> to);
/// Downsampling, after the step: removes points whose parameter `next` lacks, where they coincide
/// with a neighbour.
void collapse(EdgeFront& edge, std::span<const EdgePoint> next);

/// The points of a front with parameters in [from, to], and the point in air beside an end that is
/// in the material: no material stays whole between two parts. An empty front where there are fewer
/// than two.
EdgeFront part_of(const EdgeFront& edge, double from, double to);
/// One front of two, the parameters of `a` below those of `b`; it keeps the crack number of `a`.
EdgeFront joined(EdgeFront a, const EdgeFront& b);
/// A front with further points at its ends, where its edge has come from air: those of `points`,
/// ascending in parameter, beyond the front. An end that gets a single one stays.
EdgeFront grown(EdgeFront edge, std::span<const EdgePoint> points);

}  // namespace geo
