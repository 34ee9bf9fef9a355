// Overlapping subdomains of nodes for the Schwarz preconditioner, and the stiffness at rest between
// the nodes of each.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

struct BlockOuterProducts;

/// Input of subdomains. Refers to everything.
struct SubdomainInput {
  const std::vector<Vec3>& position;   ///< per node, material coordinates
  const NodalGradientOperator& mls;    ///< neighbours of nodes
  const std::vector<double>& spacing;  ///< per node
  const MaterialPoints& points;        ///< over which the stiffness is summed
};

class Subdomains {
 public:
  /// No subdomains.
  Subdomains() = default;
  /// Builds from scratch. A bisection tree over a cube about the origin is divided until its leaves
  /// have at most six nodes. The nodes of a leaf that are connected form the core of a subdomain. A
  /// neighbour j of a core node i overlaps it if |x_i − x_j| < 0.9 · min(spacing_i, spacing_j).
  /// Six and 0.9 are measured (docs/decisions/043).
  explicit Subdomains(const SubdomainInput& input);
  /// Updates subdomains after nodes and points have changed; the result equals a build from
  /// scratch, bit for bit. `changed`: per node, whether its position, spacing or neighbourhood
  /// changed. `changes`: what the same cut changed in the material points. Returns per subdomain
  /// its old index if nodes and sums are unchanged, else ~0u (none).
  std::vector<std::uint32_t> update(const SubdomainInput& input, const std::vector<char>& changed,
                                    const PointChanges& changes);

  /// A node of a subdomain: `slot` is its local index, that in nodes(subdomain). Not to be confused
  /// with the scatter slots of MaterialPoints.
  struct Incidence {
    std::uint32_t subdomain, slot;
    /// Equality of both members.
    friend bool operator==(const Incidence&, const Incidence&) = default;
  };
  /// Number of subdomains.
  std::size_t count() const { return first_.size() - 1; }
  /// The nodes of a subdomain, ascending.
  std::span<const std::uint32_t> nodes(std::size_t subdomain) const {
    return {node_.data() + first_[subdomain], first_[subdomain + 1] - first_[subdomain]};
  }
  /// Offset of a subdomain's first node in the concatenation of nodes(); its length for subdomain =
  /// count().
  std::size_t first(std::size_t subdomain) const { return first_[subdomain]; }
  /// The subdomains of a node, ascending.
  std::span<const Incidence> subdomains_of(std::size_t node) const {
    return {incidence_.data() + begin_[node], begin_[node + 1] - begin_[node]};
  }

  /// For slots a ≥ b of a subdomain, twelve numbers at 12 (a (a + 1) / 2 + b): the rows of
  /// Σ w g_a g_bᵀ over material points. A zero follows each row, so that it is one vector of four
  /// lanes. w: a point's unscaled_volume, which no cut elsewhere changes; g: its shape gradients.
  const float* outer_products(std::size_t subdomain) const { return outer_[subdomain].data(); }
  /// The material point that sees most nodes of a subdomain: block, and index there. Block ~0u: no
  /// point sees any.
  std::pair<std::uint32_t, std::uint32_t> point(std::size_t subdomain) const { return point_[subdomain]; }
  /// Equality of all data, bit for bit.
  friend bool operator==(const Subdomains&, const Subdomains&) = default;

 private:
  using NodeLists = std::vector<std::vector<std::uint32_t>>;
  void list(const SubdomainInput& input, const Subdomains* before = nullptr,
            const std::vector<char>* changed = nullptr);
  std::vector<NodeLists> lists_of_boxes(const SubdomainInput& input, const Subdomains* before,
                                        const std::vector<char>* changed);
  void index(const NodeLists& nodes, std::size_t node_count);
  std::vector<std::uint32_t> subdomains_at(const PointBlock& block, const std::vector<char>& wanted) const;
  BlockOuterProducts sum_block(const PointBlock& block, std::span<const std::uint32_t> subdomains) const;
  void sum_points(const MaterialPoints& points, const std::vector<char>& wanted);

  std::vector<std::size_t> first_{0};                           // per subdomain and one more, into node_
  std::vector<std::uint32_t> node_;                             // nodes by subdomain
  std::vector<std::uint32_t> begin_;                            // per node and one more, into incidence_
  std::vector<Incidence> incidence_;                            // subdomains by node
  std::vector<std::uint32_t> box_;                              // per node: its leaf, a box
  std::vector<std::uint32_t> first_of_box_;                     // per leaf and one more: its first subdomain
  std::vector<std::vector<float>> outer_;                       // per subdomain
  std::vector<std::pair<std::uint32_t, std::uint32_t>> point_;  // per subdomain
};

}  // namespace geo
