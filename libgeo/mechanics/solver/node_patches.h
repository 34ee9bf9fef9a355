// Small overlapping patches of nodes, and the stiffness at rest between the nodes of each: what the
// preconditioner's first level is made of.
#pragma once

#include <cstdint>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

class NodePatches {
 public:
  NodePatches() = default;
  /// Boxes of half a dozen nodes, which are halves of halves of cubes about the origin; then what
  /// hangs together in a box, with the neighbours of these nodes within 0.9 of both spacings.
  NodePatches(const std::vector<Vec3>& position, const NodalGradientOperator& rows, const std::vector<double>& spacing,
              const MaterialPoints& points);
  /// After nodes and points have changed: lists and sums anew what that concerns. `other`: per
  /// node, whether its place, spacing or row is another than it was. The result is that of a build
  /// from scratch, bit for bit. Returns for each patch the number of the one that it was before,
  /// with the same nodes and sums; ~0u: it was none.
  std::vector<std::uint32_t> follow(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
                                    const std::vector<double>& spacing, const std::vector<char>& other,
                                    const MaterialPoints& points, const PointChanges& changes);

  struct Incidence {
    std::uint32_t patch, slot;
    friend bool operator==(const Incidence&, const Incidence&) = default;
  };
  std::size_t count() const { return first_.size() - 1; }
  std::span<const std::uint32_t> nodes(std::size_t patch) const {
    return {&node_[first_[patch]], first_[patch + 1] - first_[patch]};
  }
  /// Number of a patch's first node in a list of all patches' nodes; that list's length after the
  /// last.
  std::size_t first(std::size_t patch) const { return first_[patch]; }
  /// Where a node is, in the order of patches.
  std::span<const Incidence> patches_of(std::size_t node) const {
    return {&at_[begin_[node]], begin_[node + 1] - begin_[node]};
  }

  /// Of slots a ≥ b of a patch twelve numbers at a (a + 1) / 2 + b: rows of Σ w g_a g_bᵀ and a zero
  /// each; w: volumes as they were measured.
  const float* outer(std::size_t patch) const { return outer_[patch].data(); }
  /// The material point that has most of a patch's nodes: block, and place there. ~0u: none has
  /// any.
  std::pair<std::uint32_t, std::uint32_t> point(std::size_t patch) const { return point_[patch]; }
  friend bool operator==(const NodePatches&, const NodePatches&) = default;

 private:
  void list(const std::vector<Vec3>& position, const NodalGradientOperator& rows, const std::vector<double>& spacing,
            const NodePatches* before = nullptr, const std::vector<char>* other = nullptr);
  void sum_points(const MaterialPoints& points, const std::vector<char>& wanted);
  std::vector<std::size_t> first_{0};
  std::vector<std::uint32_t> node_, begin_;
  std::vector<std::uint32_t> box_;          // per node: its box
  std::vector<std::uint32_t> first_patch_;  // of each box, and their number
  std::vector<Incidence> at_;
  std::vector<std::vector<float>> outer_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> point_;
};

}  // namespace geo
