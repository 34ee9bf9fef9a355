// Inner loops of the Schwarz preconditioner in vectors: outer products of shape gradients, inverses
// of the stiffness of subdomains, products with these inverses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/solver/subdomains.h"

namespace geo {

/// The contribution of one block's points to the outer products of subdomains.
struct BlockOuterProducts {
  /// The first point that sees the largest number of a subdomain's nodes.
  struct BestPoint {
    std::uint32_t nodes, point;
  };
  std::vector<std::uint32_t> subdomains;  ///< ascending
  std::vector<std::size_t> first;         ///< per subdomain and one more, into `outer`
  std::vector<float> outer;               ///< per subdomain, as Subdomains::outer_products
  std::vector<BestPoint> best_point;      ///< per subdomain
};
/// Adds the points of a block. `places`, from first[k] to first[k + 1] for node k of the block: its
/// incidences, with indices into out.subdomains instead of subdomains.
void add_outer_products(const PointBlock& block, std::span<const std::uint32_t> first,
                        std::span<const Subdomains::Incidence> places, BlockOuterProducts& out);

/// Stride of the rows of a matrix with `size` columns: the next multiple of sixteen.
constexpr std::size_t padded(std::size_t size) { return (size + 15) / 16 * 16; }

/// The stiffness of eight subdomains side by side, all padded to the node number of the largest:
/// number k of any list is that of subdomain l at 8 k + l. Where all numbers of a node are zero,
/// because it is fixed or padding, so are those of the inverse.
struct EightSubdomains {
  std::size_t nodes = 0;         ///< of each
  std::vector<float> tiles;      ///< of nodes a ≥ b at a (a + 1) / 2 + b: Σ w g_a g_bᵀ by rows; later −K⁻¹
  std::vector<float> blocks;     ///< nine per node: the diagonal block without elasticity, by columns
  std::vector<float> share;      ///< per node: factor of its rows and columns of the inverse
  std::array<float, 72> turn{};  ///< rotation by columns, whose inverse is applied to `blocks`
  std::array<float, 8> shear{};  ///< shear modulus, Pa
  std::array<float, 8> bulk{};   ///< λ, Pa
  std::vector<std::uint16_t> halves;  ///< the result: upper halves of the inverse's floats, in the order of `tiles`
  std::vector<float> diagonal;        ///< three per node: of K
  std::vector<float> scratch;         ///< of invert_positive()

  /// Sets the number of nodes and clears all numbers.
  void begin(std::size_t count);
};
/// Computes `halves` and `diagonal` from the other members. A row whose pivot is not positive
/// beyond rounding is left out.
void invert_positive(EightSubdomains& subdomains);
/// out = matrix · x for a symmetric matrix of upper halves of floats. Matrix rows, x and out have
/// padded(size) numbers.
void multiply_halves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out);
/// The same for a matrix of floats.
void multiply_floats(std::size_t size, const float* matrix, const float* x, float* out);

}  // namespace geo
