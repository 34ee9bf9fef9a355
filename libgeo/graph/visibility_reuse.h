// Reuse of visibility: a pair that saw each other before a step still does, unless a new face came
// between.
#pragma once

#include <cstdint>
#include <span>

#include "graph/adjacency_store.h"

namespace geo {

/// Set in entries of entries_to_retest() that a new face hides.
constexpr std::uint32_t hidden_bit = std::uint32_t(1) << 31;

/// Entries of a node's new row (`to`, `bits`) whose visibility does not follow from its old row.
/// Entry e is one if it is no edge, and it was not visible or to[e] is in `hidden` (ascending).
/// Writes indices e, ascending, with hidden_bit if e was visible and to[e] is in `hidden`. Returns
/// their number.
std::size_t entries_to_retest(std::span<const std::uint32_t> to, std::span<const std::uint16_t> bits,
                              const AdjacencyRow& old, std::span<const std::uint32_t> hidden, std::uint32_t* retest);

}  // namespace geo
