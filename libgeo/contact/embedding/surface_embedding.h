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
  double gap;                          ///< largest separation that untangling wants, model units
};

/// Embeds the new vertices of a crack step; old ones keep their positions.
///
/// A new vertex on an old face keeps its barycentric coordinates in this face. Copies on the two
/// sides of a face with coincident corners get the same position, to the bit. A new vertex x inside
/// the material continues the deformed surface: each old point p, now at p', proposes the position
/// p' + x − p + u(x) − u(p), where u is the blended displacement (Eq. 1 of the paper). The mean of
/// the proposals has weights |x − p|⁻⁴. The points p are the closest points to x of old faces. They
/// are at most as far from x (at rest) as the corners of the faces at x, and no old face lies in
/// between. The two sides of a new face coincide.
///
/// Triangles are flat and Eq. 1 is not, so some may cross: untangle.h separates them. Throws
/// GeometryError if some still cross.
EmbeddedSurface embed_new_surface(const EmbeddingInput& input);

}  // namespace geo
