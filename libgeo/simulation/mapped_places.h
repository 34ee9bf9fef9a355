// Places of blades in the material, as exact as the map that gives them.
#pragma once

#include "geometry/resolution.h"
#include "kerf/complex.h"

namespace geo {

/// Rounds places that the inverse deformation has given. In a body at rest it returns a place with
/// an error of some 1e-12 of its size, and exact predicates would see it: a blade in a plane of
/// the mesh would leave specks, one in a face would shave it. Refers to the complex.
class MappedPlaces {
 public:
  /// For the places in a body with this complex.
  explicit MappedPlaces(const Complex& surface);
  /// The place on a grid of 2⁻³³ (1.2e-10) of the model's size: a hundred times the error, so that
  /// a plane along axes stays a plane. A place so near to the skin goes outside, by ten units of
  /// the grid: whether it is in the material is not known.
  Vec3 resolved(const Vec3& place) const;

 private:
  const Complex& surface_;
  Resolution resolution_;
};

}  // namespace geo
