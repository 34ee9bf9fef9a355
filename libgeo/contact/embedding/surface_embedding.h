// The embedding of a crack step's new surface vertices in the deformed body.
#pragma once

#include "contact/surface/contact_surface.h"
#include "kerf/solid.h"

namespace geo {

/// The surface after a crack step, with its embedding.
struct EmbeddedSurface {
  ContactSurface surface;       ///< after the step
  std::vector<Vec3> positions;  ///< per surface vertex after the step, world
};

/// A deformed body and a crack step. Refers to data of the caller.
struct EmbeddingInput {
  const Body& body;                    ///< before the step
  const Solid& solid;                  ///< of the body
  const State& state;                  ///< displacements of its nodes
  const ContactSurface& before;        ///< the body's surface
  const std::vector<Vec3>& positions;  ///< per surface vertex before the step, world
  const Complex& after;                ///< the complex after the step
  const CrackDelta& crack;             ///< the step
  double gap;                          ///< longest distance by which triangles are untangled, model units
};

/// Embeds the new vertices of a crack step; old ones keep their positions. A new vertex on an old
/// face keeps its place in this face, equal to the bit on both sides of a sheet that is closed
/// there. A new vertex inside the material continues the deformed surface: the mean of what Eq. 1
/// predicts from each visible point of the old surface nearby, weighted by distance⁻⁴. The two
/// sides of a new face coincide. Triangles are flat and Eq. 1 is not, so some may cross: these
/// are untangled (untangle.h). Throws GeometryError if some still cross.
EmbeddedSurface embed_new_surface(const EmbeddingInput& input);

}  // namespace geo
