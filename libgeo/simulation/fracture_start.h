// Where cracks start: nodes at which the largest principal stress exceeds the strength.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kerf/body.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// A node at which a crack starts.
struct CrackStart {
  NodeId node;
  Vec3 normal;   ///< principal direction of the largest stress: of the crack plane, unit, material coordinates
  double ratio;  ///< of that stress to the strength there; > 1
};

/// Cauchy stress at each node, Pa, rotated back to material coordinates. It is the mean over the
/// material points that have the node in their support, weighted by volume and kernel, so it never
/// averages across a crack. Zero where a node has no such point, or all are inverted or crushed.
std::vector<Mat3> averaged_stress(const Body& body, const Solid& solid, const State& motion);

/// At most `limit` starts, the largest ratio first. No start is within `fracture.separation` node
/// spacings of a crack or of another start, nor in a box without fracture. `stress`: as
/// averaged_stress(); `body_index`: per node, its body of the scene.
std::vector<CrackStart> find_starts(const Body& body, const std::vector<Mat3>& stress, const FractureOptions& fracture,
                                    const std::vector<std::uint32_t>& body_index, std::size_t limit);

}  // namespace geo
