// Deforming bodies of one scene that touch each other (§ 3.3, between objects).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/response/body_contact_penalty.h"

namespace geo {

struct BodyContactOptions {
  double pressure = 1e6;  ///< Pa for a metre of depth
  double friction = 0.3;  ///< Coulomb's coefficient
  double reach = 0;  ///< vertices so near, or so deep, are looked at: no less than what bodies approach each other in a
                     ///< step, and a cell
  double slow = 0;   ///< a way below which friction is smooth
  std::span<const double> firmness =
      {};  ///< per node: the pressure is times the larger one of the two bodies'; empty: 1
};

/// For a step that begins at displacements u: the surface vertices that are in another body, or may come to be. Which
/// body a node belongs to is in `part`. The distance field of a body is that of its own surface in the material, asked
/// where the vertex is mapped back to (point_map.h); so it follows cuts, costs nothing to keep, and is exact at corners
/// and in thin parts. The sheets of a crack count where they are open wider than the vertex is deep. Each side's
/// vertices get half the pressure.
BodyContactPenalty body_contact(const Body& body, const Solid& solid, const SurfaceWeights& weights,
                                const std::vector<std::uint32_t>& part, const std::vector<Vec3>& u,
                                const BodyContactOptions& options);

}  // namespace geo
