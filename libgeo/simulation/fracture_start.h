// Where cracks begin.
#pragma once

#include "body/body.h"
#include "mechanics/solid.h"
#include "simulation/fracture.h"

namespace geo {

/// A place where the stress has passed the strength.
struct CrackStart {
  NodeId node;
  Vec3 normal;   ///< of the plane that the largest principal stress pulls apart, unit, material coordinates
  double share;  ///< of that stress in the strength there; > 1
};

/// Cauchy's stress at each node, turned back by the material's rotation there, averaged over the node's neighbours along the
/// graph by the kernel: no average reaches across a crack. Pa, in material coordinates.
std::vector<Mat3> averaged_stress(const Body& body, const std::vector<Mat3>& gradient, const Material& material);

/// Nodes whose averaged stress has passed the strength, where cracks may begin and none is within `fracture.apart`
/// spacings; the most overstrained first, none within that distance of one before it; at most `most`.
std::vector<CrackStart> find_starts(const Body& body, const std::vector<Mat3>& stress, const Fracture& fracture, std::size_t most);

}  // namespace geo
