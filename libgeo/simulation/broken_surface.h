// Places in the world of surface vertices that a break adds to a deformed body.
#pragma once

#include <functional>
#include <vector>

#include "kerf/simulation.h"

namespace geo {

/// A point of the surface of a run.
struct SurfaceHit {
  Vec3 material = Vec3::Zero();
  SurfaceVertexId nearest;  ///< vertex of the surface
  Side side = {};           ///< in which it is
};

/// A complex that has grown from another one, whose faces it divides.
struct Grown {
  const Complex& old;
  Complex now;
  std::vector<FaceId> parent = {};  ///< per face of `now`: the old face that it is of; invalid: of a new wall

  /// `to` has grown from `from`, which must outlive this.
  Grown(const Complex& from, const Complex& to);
  /// Calls visit(side) for each side of `now`.
  void for_each_side(const std::function<void(Side)>& visit) const;
};

/// The places of all living vertices, ascending, after a piece of a deformed body has broken.
/// Vertices on the old surface stay on it. Those inside move as the material did, at one place on
/// both sides of their wall.
/// \param run  before the break; its state has the places of its surface
/// \param hit  a point of the piece
std::vector<Vec3> broken_surface(const Simulation& run, const Grown& grown, const SurfaceHit& hit);

}  // namespace geo
