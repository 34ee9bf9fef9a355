// Where cracks begin.
#pragma once

#include "kerf/body.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// A place where the stress has passed the strength.
struct CrackStart {
  NodeId node;
  Vec3 normal;   ///< of the plane that the largest principal stress pulls apart, unit, material coordinates
  double share;  ///< of that stress in the strength there; > 1
};

/// For each node the mean of Cauchy's stress over the material points that take it, weighed by
/// volume and the kernel: no mean reaches across a crack, and it is the stress that forces come
/// from. Turned back by the material's rotation at the points; Pa, in material coordinates. Zero
/// where no point takes a node, or all are inside out.
std::vector<Mat3> averaged_stress(const Body& body, const Solid& solid, const State& motion);

/// Nodes whose averaged stress has passed the strength of their body, where cracks may begin and
/// none is within `fracture.separation` spacings; the most overstrained first, none within that
/// distance of one before it; at most `most`.
std::vector<CrackStart> find_starts(const Body& body, const std::vector<Mat3>& stress, const FractureOptions& fracture,
                                    const std::vector<std::uint32_t>& body_index, std::size_t most);

}  // namespace geo
