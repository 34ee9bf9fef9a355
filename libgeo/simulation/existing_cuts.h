// Cuts that are there already: an edge that moves in one is in air, and cuts nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/simulation.h"
#include "simulation/blade_way.h"
#include "simulation/edge_front.h"

namespace geo {

/// The distance of a point from the nearest living face of a crack; infinity where none is within
/// `reach`. Lengths in model units.
double distance_from_crack(const Complex& surface, std::int32_t crack, const Vec3& point, double reach);

/// The distance of a point from the polyline of a front, contacts included; model units.
double distance_from_front(const FrontState& front, const Vec3& point);

/// Whether the front touches K, with its points or between them: it can go on in the material.
bool has_contact(const FrontState& front);

/// The cracks of a body as a blade meets them. The walls of a cut lie on each other in the
/// material, so an edge between them maps to the sheet, but for the accuracy of the map. A strip
/// there would leave crumbs beside the sheet. Refers to its arguments.
class ExistingCuts {
 public:
  /// `fronts`: of the blade, those that its edge has left included.
  ExistingCuts(const Complex& surface, std::span<const EdgeFront> fronts);
  /// Whether a place of the blade's edge in the material is in a cut, by one of two measures:
  /// - it is nearer to a sheet than a twentieth of the node spacing, which a front resolves;
  /// - it is nearer to a sheet of this blade than a quarter of it, and than half of its distance
  ///   from the blade's fronts that can go on, ahead of which the material is whole.
  /// `spacing`: of the nodes there, model units.
  bool contain(const Vec3& place, double spacing) const;
  /// Whether boxes do not exclude that contain() holds between two places.
  bool may_contain_between(const Vec3& from, const Vec3& to, double spacing) const;
  /// Whether a front that can go on has this edge parameter. It holds its points in the cut by
  /// itself (edge_retreat.h).
  bool can_go_on(double at) const;

 private:
  bool is_ahead(const Vec3& place, double distance) const;

  const Complex& surface_;
  std::span<const EdgeFront> fronts_;
  std::vector<std::int32_t> own_;  // numbers of this blade's cracks, ascending
};

/// Where the front of a run begins. A point that has come from a cut, or from air, since the
/// fraction `before` of the time step begins there; in a cut, a twentieth of a node spacing over
/// its sheet. One that has come from beyond the supports of nodes begins as far back on its way as
/// there is air. The others begin where they are. `fronts`: of the blade.
std::vector<EdgePoint> begin_of_run(const MovedBody& moved, const Blade& blade, double before,
                                    std::span<const EdgePoint> run, std::span<const EdgeFront> fronts);

/// The points of a run beyond the parameters of its front that were in air at the fraction `before`
/// of the time step, where they were then: the edge enters the body there.
std::vector<EdgePoint> entering(const MovedBody& moved, const Blade& blade, double before,
                                std::span<const EdgePoint> run, const EdgeFront& edge);

/// Makes the first step of a front that begins in a cut cross the sheet, behind its border. So the
/// next step, which passes the border on the other side, leaves no bridge: sheets that only touch,
/// but for rounding, need not meet. Changes `to` where the front begins in a cut. `spacing`: of
/// nodes at each point, model units.
void cross_first(const Complex& surface, const FrontState& front, std::span<const double> spacing,
                 std::vector<Vec3>& to);

}  // namespace geo
