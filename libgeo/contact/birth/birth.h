// Where the surface that a crack step makes comes to be in a deformed body.
#pragma once

#include "contact/surface/contact_surface.h"
#include "kerf/solid.h"

namespace geo {

struct Birth {
  ContactSurface surface;       ///< after the step
  std::vector<Vec3> positions;  ///< per surface vertex after the step, world
};

/// The body's surface is `before`, at `positions`; a crack step makes it `grown`. What was there stays where it is. New
/// vertices on old faces take their place in these, the same to the bit on both sides of a sheet that is together
/// there; the two sides of a new face are together. Those inside the material continue the deformed surface: from each
/// place near them they are as far as Eq. 1, by the nodes there, has them, the nearest places saying most. Triangles
/// are flat and Eq. 1 is not, so some may cross: they are pushed apart (untangle.h). `gap`: model units, as far as they
/// are pushed at most. Throws GeometryError when some still cross.
Birth give_birth(const Body& body, const Solid& solid, const State& state, const ContactSurface& before,
                 const std::vector<Vec3>& positions, const Complex& grown, const CrackDelta& crack, double gap);

}  // namespace geo
