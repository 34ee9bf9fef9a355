#include "mechanics/terms/row_lists.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"

namespace geo {

RowLists::RowLists(std::span<const std::uint32_t> rows, const std::vector<std::span<const NodeWeight>>& entries,
                   std::size_t nodes)
    : rows_(rows.begin(), rows.end()), first_own_(1, 0), first_share_(nodes + 1, 0) {
  first_own_.reserve(rows_.size() + 1);
  for (const auto r : rows_) first_own_.push_back(first_own_.back() + entries[r].size());
  // Runs of rows count their nodes each, then know where each node's shares from them go.
  constexpr std::size_t most_runs = 8, rows_a_run = 256;
  const std::size_t runs = std::clamp<std::size_t>(rows_.size() / rows_a_run, 1, most_runs);
  const auto begin_of = [&](std::size_t run) { return rows_.size() * run / runs; };
  std::vector<std::vector<std::uint32_t>> next(runs);
  own_ = UninitializedArray<Share>(first_own_.back());
  parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run) {
      next[run].assign(nodes, 0);
      for (std::size_t k = begin_of(run); k < begin_of(run + 1); ++k) {
        Share* to = own_.data() + first_own_[k];
        for (const auto& e : entries[rows_[k]]) *to++ = {e.node, static_cast<float>(e.weight)}, ++next[run][e.node];
      }
    }
  });
  std::uint32_t at = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    first_share_[n] = at;
    for (auto& of_run : next) at += std::exchange(of_run[n], at);
  }
  first_share_[nodes] = at;
  shares_ = UninitializedArray<Share>(at), weights_ = UninitializedArray<double>(at);
  parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run)
      for (std::size_t k = begin_of(run); k < begin_of(run + 1); ++k)
        for (const auto& e : entries[rows_[k]]) {
          const auto to = next[run][e.node]++;
          shares_[to] = {rows_[k], static_cast<float>(e.weight)}, weights_[to] = e.weight;
        }
  });
}

}  // namespace geo
