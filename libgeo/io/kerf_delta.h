// What changed from one array to another, whatever they mean.
#pragma once

#include "io/kerf_layout.h"

namespace geo::kerf {

/// The runs that make `after` from `before`, both arrays of rows of `width` bytes; rows that are copied ascend. Finds
/// what moved because rows were inserted or removed before it, as well as what stayed in place; stretches below 512
/// bytes between two changes may be given instead of copied. Linear in practice.
std::vector<Run> difference(std::span<const std::byte> before, std::span<const std::byte> after, std::size_t width);

}  // namespace geo::kerf
