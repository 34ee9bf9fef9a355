// The contact Jacobian of selected stencils as a sparse matrix, stored by stencil (CSR) and by node
// (CSC).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/potential.h"

namespace geo {

/// Sums over stencils gather by stencil and sums at nodes gather by node, so threads never write to
/// the same value.
class StencilMatrix {
 public:
  struct Entry {
    std::uint32_t index;  ///< a node (stored by stencil) or a stencil (stored by node)
    float weight;
  };
  /// Without stencils.
  StencilMatrix() = default;
  /// Takes the stencils `selected`, ascending indices into `stencils`, over `nodes` nodes.
  StencilMatrix(std::span<const std::uint32_t> selected, const std::vector<Stencil>& stencils, std::size_t nodes);

  /// The number of selected stencils.
  std::size_t size() const { return selected_.size(); }
  /// The index of the k-th selected stencil.
  std::uint32_t stencil(std::size_t k) const { return selected_[k]; }
  /// The nodes of the k-th selected stencil, with weights in single precision.
  std::span<const Entry> nodes_of(std::size_t k) const {
    return {by_stencil_.data() + stencil_begin_[k], by_stencil_.data() + stencil_begin_[k + 1]};
  }
  /// The stencils that a node belongs to, ascending, with weights in single precision.
  std::span<const Entry> stencils_of(std::size_t node) const {
    return size() == 0
               ? std::span<const Entry>()
               : std::span<const Entry>{by_node_.data() + node_begin_[node], by_node_.data() + node_begin_[node + 1]};
  }
  /// The weights of stencils_of(node), in double precision. Precondition: size() > 0.
  const double* weights_of(std::size_t node) const { return weights_.data() + node_begin_[node]; }

 private:
  std::vector<std::uint32_t> selected_;
  std::vector<std::size_t> stencil_begin_, node_begin_;
  UninitializedArray<Entry> by_stencil_, by_node_;
  UninitializedArray<double> weights_;  // of by_node_
};

}  // namespace geo
