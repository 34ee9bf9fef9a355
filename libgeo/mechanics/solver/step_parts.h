// What of a solid can be solved on its own in a time step: nodes that neither material points nor contact join to
// others. One that has converged costs nothing more, and none waits for another's line search.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/parallel.h"
#include "mechanics/discretisation/material_points.h"
#include "mechanics/solver/node_patches.h"

namespace geo {

class StepParts {
 public:
  /// `component`: per node, of the graph, of so many; `coupled`: components that something else joins. Refers to
  /// `patches`.
  StepParts(const MaterialPoints& points, const NodePatches& patches, const std::vector<std::uint32_t>& component,
            std::uint32_t components, std::span<const std::pair<std::uint32_t, std::uint32_t>> coupled);
  std::size_t count() const { return count_; }
  std::uint32_t of(std::size_t node) const { return of_[node]; }
  /// The same of all nodes.
  std::span<const std::uint32_t> of_nodes() const { return of_; }
  /// What is joined without what `coupled` says: how many of these, and each node's.
  std::size_t pieces() const { return pieces_; }
  const std::vector<std::uint32_t>& piece_of_nodes() const { return piece_; }
  /// Parts that a block's points belong to, ascending; empty: it has no nodes.
  std::span<const std::uint32_t> of_block(std::size_t block) const {
    return {&block_part_[block_first_[block]], block_first_[block + 1] - block_first_[block]};
  }
  /// Number of a block's first part in a list of all blocks' parts; that list's length after the last.
  std::size_t block_first(std::size_t block) const { return block_first_[block]; }
  /// Which of its block's parts a point belongs to; 0 for one without nodes.
  std::size_t slot(std::size_t block, const PointBlock& points, std::size_t point) const;

  /// Parts at work from now on; at first all.
  void choose(const std::vector<char>& chosen);
  const std::vector<char>& chosen() const { return chosen_; }
  /// Blocks with points of parts at work, their patches.
  std::span<const std::uint32_t> blocks() const { return blocks_; }
  std::span<const std::uint32_t> patches() const { return patches_; }

  /// Calls work(node) for all nodes of parts at work, from any thread.
  template <class Work>
  void each_node(const Work& work) const {
    each_run([&](const Run& run) {
      for (auto k = run.begin; k < run.end; ++k) work(node_[k]);
    });
  }
  /// sum[part] of term(node) for each part at work, from `zero` on, in an order that no number of threads changes;
  /// those of others stay.
  template <class Sum, class Term>
  void sums(std::vector<Sum>& sum, const Sum& zero, const Term& term) const {
    reduce(
        sum, zero, [&](Sum& total, std::uint32_t node) { total += term(node); },
        [](Sum& total, const Sum& run) { total += run; });
  }
  /// The same of the largest, where none is negative; NaN is larger than any.
  template <class Term>
  void most(std::vector<double>& most, const Term& term) const {
    reduce(
        most, 0.0, [&](double& own, std::uint32_t node) { keep_larger(own, term(node)); }, keep_larger);
  }
  /// Both at once: of what term(node) returns, the first is summed, of the second there is the largest.
  template <class Term>
  void sums_and_most(std::vector<double>& sum, std::vector<double>& most, const Term& term) const {
    using Both = std::pair<double, double>;
    std::vector<Both> both;
    reduce(
        both, Both(0, 0),
        [&](Both& own, std::uint32_t node) {
          const Both more = term(node);
          own.first += more.first, keep_larger(own.second, more.second);
        },
        [](Both& own, const Both& run) { own.first += run.first, keep_larger(own.second, run.second); });
    sum.resize(count_, 0), most.resize(count_, 0);
    for (std::size_t p = 0; p < count_; ++p)
      if (chosen_[p]) sum[p] = both[p].first, most[p] = both[p].second;
  }

 private:
  static void keep_larger(double& most, double x) { most = most >= x ? most : most != most ? most : x; }
  struct Run {
    std::uint32_t part, begin, end;  // of node_
  };
  template <class Work>
  void each_run(const Work& work) const {
    parallel_for(runs_.size(), std::max<std::size_t>(1, 1024 * runs_.size() / (nodes_at_work_ + 1)),
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t k = begin; k < end; ++k) work(runs_[k]);
                 });
  }
  template <class Result, class Take, class Join>
  void reduce(std::vector<Result>& result, const Result& zero, const Take& take, const Join& join) const {
    std::vector<Result> of_run(runs_.size(), zero);
    each_run([&](const Run& run) {
      Result& own = of_run[static_cast<std::size_t>(&run - runs_.data())];
      for (auto k = run.begin; k < run.end; ++k) take(own, node_[k]);
    });
    result.resize(count_, zero);
    for (std::size_t p = 0; p < count_; ++p)
      if (chosen_[p]) result[p] = zero;
    for (std::size_t k = 0; k < runs_.size(); ++k) join(result[runs_[k].part], of_run[k]);
  }

  const NodePatches& all_patches_;
  std::size_t count_ = 0, pieces_ = 0, nodes_at_work_ = 0;
  std::vector<std::uint32_t> of_, piece_, node_,
      first_;  // per node, its part and piece; nodes by part; per part and one more: its first there
  std::vector<std::uint32_t> block_part_;
  std::vector<std::size_t> block_first_;
  std::vector<char> chosen_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> blocks_, patches_;
};

}  // namespace geo
