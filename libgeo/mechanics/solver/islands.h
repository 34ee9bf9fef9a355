// Islands: decoupled subsystems of a time step. No material point and no contact joins the nodes of
// two islands, so each has its own line search and its own end of Newton's method and of conjugate
// gradients.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/parallel.h"
#include "mechanics/discretisation/material_points.h"
#include "mechanics/solver/subdomains.h"

namespace geo {

/// The islands of a time step and, below them, the free-floating islands: what would be islands if
/// contact coupled nothing. A free-floating island that nothing holds moves as a whole like a rigid
/// body.
class Islands {
 public:
  /// `component`: per node, its component of the graph, below `components`; `coupled`: pairs of
  /// components that contact joins.
  Islands(const MaterialPoints& points, const std::vector<std::uint32_t>& component, std::uint32_t components,
          std::span<const std::pair<std::uint32_t, std::uint32_t>> coupled);
  /// Number of islands.
  std::size_t count() const { return count_; }
  /// The island of a node.
  std::uint32_t of(std::size_t node) const { return of_[node]; }
  /// The island of each node.
  std::span<const std::uint32_t> of_nodes() const { return of_; }
  /// Number of free-floating islands.
  std::size_t free_count() const { return free_count_; }
  /// The free-floating island of each node.
  const std::vector<std::uint32_t>& free_of_nodes() const { return free_of_; }
  /// The nodes of an island, ascending.
  std::span<const std::uint32_t> nodes(std::size_t island) const {
    return {node_.data() + first_[island], first_[island + 1] - first_[island]};
  }
  /// The islands that a block's points belong to, ascending; empty for a block without nodes.
  std::span<const std::uint32_t> of_block(std::size_t block) const {
    return {block_island_.data() + block_first_[block], block_first_[block + 1] - block_first_[block]};
  }
  /// Offset of a block's first island in the concatenation of of_block(); its length for block =
  /// number of blocks.
  std::size_t block_first(std::size_t block) const { return block_first_[block]; }
  /// Number of blocks.
  std::size_t block_count() const { return block_first_.size() - 1; }
  /// Index in of_block() of the island that a point belongs to; 0 for a point without nodes.
  std::size_t slot(std::size_t block, const PointBlock& points, std::size_t point) const;

 private:
  std::size_t count_ = 0, free_count_ = 0;
  std::vector<std::uint32_t> of_, free_of_;  // per node
  std::vector<std::uint32_t> node_, first_;  // nodes by island; per island and one more: its first there
  std::vector<std::uint32_t> block_island_;  // concatenation of of_block()
  std::vector<std::size_t> block_first_;     // per block and one more
};

/// A selection of islands. Computations run over the nodes, blocks and subdomains of the selected
/// islands and leave the entries of all others as they are.
class ActiveIslands {
 public:
  /// Selects all islands. Refers to both arguments.
  ActiveIslands(const Islands& islands, const Subdomains& subdomains);
  /// Selects the islands with a nonzero entry. `mask` has one entry per island.
  void select(const std::vector<char>& mask);
  /// One entry per island: 1 if selected.
  const std::vector<char>& mask() const { return mask_; }
  /// Whether an island is selected.
  bool operator[](std::size_t island) const { return mask_[island] != 0; }
  /// Whether no island is selected.
  bool none() const { return std::find(mask_.begin(), mask_.end(), 1) == mask_.end(); }
  /// All islands, selected or not.
  const Islands& islands() const { return islands_; }
  /// Blocks with points of selected islands, ascending.
  std::span<const std::uint32_t> blocks() const { return blocks_; }
  /// Subdomains of selected islands, ascending.
  std::span<const std::uint32_t> subdomains() const { return active_subdomains_; }

  /// Calls work(node) for each node of the selected islands, from any thread.
  template <class Work>
  void each_node(const Work& work) const {
    each_run([&](const Run& run) {
      for (const auto node : run.nodes) work(node);
    });
  }
  /// sum[island] = zero + Σ term(node) for the selected islands, in an order that no number of
  /// threads changes.
  template <class Sum, class Term>
  void sum(std::vector<Sum>& sum, const Sum& zero, const Term& term) const {
    reduce(
        sum, zero, [&](Sum& total, std::uint32_t node) { total += term(node); },
        [](Sum& total, const Sum& run) { total += run; });
  }
  /// maximum[island] = max term(node) for the selected islands. No term is negative; NaN exceeds
  /// every number.
  template <class Term>
  void maximum(std::vector<double>& maximum, const Term& term) const {
    reduce(
        maximum, 0.0, [&](double& own, std::uint32_t node) { keep_larger(own, term(node)); }, keep_larger);
  }
  /// sum() of the first and maximum() of the second number of term(node), in one pass.
  template <class Term>
  void sum_and_maximum(std::vector<double>& sum, std::vector<double>& maximum, const Term& term) const {
    using Both = std::pair<double, double>;
    std::vector<Both> both;
    reduce(
        both, Both(0, 0),
        [&](Both& own, std::uint32_t node) {
          const Both more = term(node);
          own.first += more.first;
          keep_larger(own.second, more.second);
        },
        [](Both& own, const Both& run) {
          own.first += run.first;
          keep_larger(own.second, run.second);
        });
    sum.resize(mask_.size(), 0);
    maximum.resize(mask_.size(), 0);
    for (std::size_t p = 0; p < mask_.size(); ++p)
      if (mask_[p]) {
        sum[p] = both[p].first;
        maximum[p] = both[p].second;
      }
  }
  /// Replaces the entries of the selected islands by their square roots.
  void take_square_roots(std::vector<double>& values) const {
    for (std::size_t p = 0; p < mask_.size(); ++p)
      if (mask_[p]) values[p] = std::sqrt(values[p]);
  }

 private:
  // Nodes of one island that one thread visits one after another.
  struct Run {
    std::uint32_t island;
    std::span<const std::uint32_t> nodes;
  };
  static void keep_larger(double& maximum, double x) {
    maximum = maximum >= x ? maximum : maximum != maximum ? maximum : x;
  }
  template <class Work>
  void each_run(const Work& work) const {
    parallel_for(runs_.size(), std::max<std::size_t>(1, 1024 * runs_.size() / (node_count_ + 1)),
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t k = begin; k < end; ++k) work(runs_[k]);
                 });
  }
  template <class Result, class AddNode, class AddRun>
  void reduce(std::vector<Result>& result, const Result& zero, const AddNode& add_node, const AddRun& add_run) const {
    std::vector<Result> of_run(runs_.size(), zero);
    each_run([&](const Run& run) {
      Result& own = of_run[static_cast<std::size_t>(&run - runs_.data())];
      for (const auto node : run.nodes) add_node(own, node);
    });
    result.resize(mask_.size(), zero);
    for (std::size_t p = 0; p < mask_.size(); ++p)
      if (mask_[p]) result[p] = zero;
    for (std::size_t k = 0; k < runs_.size(); ++k) add_run(result[runs_[k].island], of_run[k]);
  }

  const Islands& islands_;
  const Subdomains& all_subdomains_;
  std::vector<char> mask_;
  std::size_t node_count_ = 0;  // of the selected islands
  std::vector<Run> runs_;
  std::vector<std::uint32_t> blocks_, active_subdomains_;
};

}  // namespace geo
