// Aggregates of nodes: the rigid bodies that span the coarse space of the preconditioner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

/// Connected nodes, a hundred or so in an aggregate.
struct Aggregates {
  std::vector<std::uint32_t> of;         ///< per node: its aggregate
  std::vector<std::uint32_t> component;  ///< per aggregate: its component of the graph, ascending
  /// Number of aggregates.
  std::size_t count() const { return component.size(); }

  /// Bounds of the size of aggregates. Ninety-six nodes cost as many iterations as forty, and less
  /// than half the time of the factor (docs/decisions/044).
  struct Size {
    std::size_t least_nodes = 96;        ///< of a box before it is divided into connected sets
    std::size_t max_per_component = 72;  ///< boxes of a component, or twice that; bounds the bandwidth of the factor
  };
  /// No aggregates.
  Aggregates() = default;
  /// Halves the nodes of each component, along the longest side of their box, into boxes; the
  /// connected nodes of a box form an aggregate. Aggregates of a component are numbered along its
  /// longest side, so that neighbours have close numbers. `component_of`: per node, below
  /// `components`.
  Aggregates(const std::vector<Vec3>& position, const NodalGradientOperator& mls,
             const std::vector<std::uint32_t>& component_of, std::uint32_t components, const Size& size);
  /// The same with default sizes.
  Aggregates(const std::vector<Vec3>& position, const NodalGradientOperator& mls,
             const std::vector<std::uint32_t>& component_of, std::uint32_t components)
      : Aggregates(position, mls, component_of, components, Size()) {}
};

}  // namespace geo
