// Which boxes meet.
#pragma once

#include "contact/detection/box_tree.h"

namespace geo {

/// All pairs (i < j) of boxes that meet, each once, in an order that depends on the boxes alone. Finite boxes; empty
/// ones meet none. Only pairs with a box marked in `only`, where given.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>> close_pairs(
    std::vector<Box3> boxes, const std::vector<std::uint8_t>* only = nullptr) {
  return BoxTree(std::move(boxes)).pairs(only);
}

}  // namespace geo
