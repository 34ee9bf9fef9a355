// Places in the world of surface vertices that a break adds to a deformed body.
#pragma once

#include <functional>
#include <vector>

#include <kerf/simulation.h>
#include "live/surface_view.h"

namespace live {

/// A complex that has grown from another one, whose faces it divides.
struct Grown {
  const geo::Complex& old;
  geo::Complex now;
  std::vector<geo::FaceId> parent = {};  ///< per face of `now`: the old face that it is of; invalid: of a new wall

  /// `to` has grown from `from`, which must outlive this.
  Grown(const geo::Complex& from, const geo::Complex& to);
  /// Calls visit(side) for each side of `now`.
  void for_each_side(const std::function<void(geo::Side)>& visit) const;
};

/// The places of all living vertices, ascending, after a piece of a deformed body has broken.
/// Vertices on the old surface stay on it. Those inside move as the material did, at one place on
/// both sides of their wall.
/// \param run  before the break; its state has the places of its surface
/// \param hit  a point of the piece
std::vector<geo::Vec3> broken_surface(const geo::Simulation& run, const Grown& grown, const PickedPoint& hit);

}  // namespace live
