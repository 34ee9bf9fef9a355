// Chips of a score: small pieces that break off where walls meet the skin or each other.
#pragma once

#include <functional>

#include "geometry/bvh.h"
#include "kerf/complex.h"
#include "kerf/score.h"

namespace geo {

/// Adds the walls of chips to those of a score, and returns how many chips these break off. Each
/// chip is one piece, and no other piece is parted by its wall.
/// \param walls  of the score; where nothing else helps, they stay as they are, without chips
/// \param cut  `model` cut along them; receives the model cut along the new ones
/// \param skin  of the model
/// \param seed  of the places and shapes
/// \param pause  is called between stages, and may throw
std::uint32_t add_chips(TriangleMesh& walls, const Complex& model, Complex& cut, const TriangleBvh& skin,
                        const ChipOptions& options, std::uint64_t seed, const std::function<void()>& pause);

}  // namespace geo
