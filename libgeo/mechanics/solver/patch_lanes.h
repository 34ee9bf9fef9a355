// The inner loops of the preconditioner's first level, in vectors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/solver/node_patches.h"

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
void add_outer_products(const PointBlock& block, std::span<const std::uint32_t> first,
                        std::span<const NodePatches::Incidence> places, PatchParts& out);

/// Rows of a matrix of so many columns begin a multiple of sixteen numbers apart.
constexpr std::size_t padded(std::size_t size) { return (size + 15) / 16 * 16; }

/// The stiffness of eight patches side by side, which have as many nodes each as the largest of them: number k of any
/// list is patch l's at 8 k + l. Where all numbers of a node are zero, because it is held or its patch has fewer, those
/// of the inverse are, too.
struct EightPatches {
  std::size_t nodes = 0;
  std::vector<float> tiles;  // of nodes a ≥ b at a (a + 1) / 2 + b: the nine numbers of Σ w g_a g_bᵀ by rows, later of
                             // the inverse with its sign turned
  std::vector<float> blocks;     // nine a node: what it has besides
  std::vector<float> share;      // one a node
  std::array<float, 72> turn{};  // by columns; blocks are to turn back by it
  std::array<float, 8> shear{}, bulk{};
  std::vector<std::uint16_t>
      halves;                // upper halves of the inverse's numbers, times both nodes' shares; order of `tiles`
  std::vector<float> aside;  // room for what is made on the way

  /// Room for patches of so many nodes; all zero.
  void begin(std::size_t count);
};
/// From tiles, blocks and moduli to halves. A row that is not positive beyond rounding, after those before it, is taken
/// out.
void invert_positive(EightPatches& patches);
/// out = matrix · x for a symmetric matrix that is the upper halves of its numbers; all of padded(size).
void multiply_halves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out);

}  // namespace geo
