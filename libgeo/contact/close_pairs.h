// Which boxes meet: spatial hashing (Teschner, Heidelberger, Müller, Pomeranets, Gross 2003).
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace geo {

/// All pairs (i < j) of boxes that meet, each once, in an order that depends on the boxes alone. Finite boxes; empty ones meet
/// none. Cost follows the boxes and the pairs where most boxes are of similar size. Only pairs with a box marked in `only`, where
/// given.
std::vector<std::pair<std::uint32_t, std::uint32_t>> close_pairs(const std::vector<Box3>& boxes, const std::vector<std::uint8_t>* only = nullptr);

}  // namespace geo
