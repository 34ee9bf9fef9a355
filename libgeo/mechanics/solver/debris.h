// Debris: material without strain, because too few nodes carry it. It moves as rigid bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/solver/solid_discretisation.h"

namespace geo {

/// Makes components rigid whose nodes no material point joins: each gets the rigid motion nearest
/// to that of its nodes, with their momenta. If some of its nodes are fixed, these alone decide.
/// Updates State::rotation of all nodes without a full gradient. `fixed`: per node, or empty.
void keep_debris_rigid(const SolidDiscretisation& solid, const std::vector<std::uint8_t>& fixed, State& state);

/// The rotations at some nodes, by ∇u and what it lacks. `nodes` may repeat.
std::vector<Mat3> rotations_at(const NodalGradientOperator& mls, std::span<const std::uint32_t> nodes,
                               const std::vector<Vec3>& u);

}  // namespace geo
