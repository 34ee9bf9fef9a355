// Who saw a node, and does still.
#pragma once

#include <cstdint>
#include <span>

#include "graph/adjacency_store.h"

namespace geo {

/// Set in what entries_to_retest() writes where something came between.
constexpr std::uint32_t hidden_bit = std::uint32_t(1) << 31;

/// Of a node's new row: which entries are neither edges nor were seen in its old row and are still.
/// Writes their places, ascending, with hidden_bit where they were seen and are among `lost`
/// (ascending). Returns how many.
std::size_t entries_to_retest(std::span<const std::uint32_t> to, std::span<const std::uint16_t> bits,
                              const AdjacencyRow& old, std::span<const std::uint32_t> lost, std::uint32_t* unsure);

}  // namespace geo
