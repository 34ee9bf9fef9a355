// The inner loops of the preconditioner's first level, in vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/material_points.h"
#include "mechanics/node_patches.h"

namespace geo {

/// What a block of points has for the patches of its nodes.
struct PatchParts {
  struct Most {
    std::uint32_t count, point;
  };
  std::vector<std::uint32_t> patches;  // ascending
  std::vector<std::size_t> first;      // per patch and one more: where its tiles are
  std::vector<float> outer;            // as NodePatches::outer
  std::vector<Most> most;              // per patch: the first point with the greatest number of its nodes
};
/// Adds the points of a block. Per node of the block and one more `first`: its places, numbers of a patch and slots.
void add_outer_products(const PointBlock& block, std::span<const std::uint32_t> first, std::span<const NodePatches::Incidence> places, PatchParts& out);

/// Rows of a matrix of so many columns begin a multiple of sixteen numbers apart.
constexpr std::size_t padded(std::size_t size) { return (size + 15) / 16 * 16; }
/// The inverse of a positive matrix, by Gauss and Jordan. A row that is not positive beyond rounding is taken out.
void invert_positive(std::size_t size, float* matrix);
/// out = matrix · x for a symmetric matrix that is the upper halves of its numbers; all of padded(size).
void multiply_halves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out);

}  // namespace geo
