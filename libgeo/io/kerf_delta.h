// Difference of two arrays of rows, for updates of `.kerf` files.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "io/kerf_layout.h"

namespace geo::kerf {

/// Runs that make `after` from `before`: rows copied from `before`, ascending, and literal rows.
/// Rows have `width` bytes. Finds rows that stayed in place and rows that moved because others were
/// inserted or removed. Equal stretches below 512 bytes between two changes may be literal. Linear
/// time in practice.
std::vector<Run> difference(std::span<const std::byte> before, std::span<const std::byte> after, std::size_t width);

}  // namespace geo::kerf
