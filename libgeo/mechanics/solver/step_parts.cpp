#include "mechanics/solver/step_parts.h"

#include "base/union_find.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::uint32_t most_a_run = 512;

}  // namespace

StepParts::StepParts(const MaterialPoints& points, const NodePatches& patches,
                     const std::vector<std::uint32_t>& component, std::uint32_t components,
                     std::span<const std::pair<std::uint32_t, std::uint32_t>> coupled)
    : all_patches_(patches), of_(component.size(), 0), piece_(of_), node_(component.size()) {
  UnionFind joined(components);
  std::vector<char> of_one(points.blocks.size());
  parallel_for(of_one.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto& nodes = points.blocks[b].nodes;
      of_one[b] = std::all_of(nodes.begin(), nodes.end(), [&](auto j) { return component[j] == component[nodes[0]]; });
    }
  });
  // A point may see nodes that see nothing of each other.
  for (std::size_t b = 0; b < of_one.size(); ++b) {
    const PointBlock& block = points.blocks[b];
    if (of_one[b]) continue;
    for (std::size_t i = 0; i < block.points.size(); ++i)
      for (auto q = block.entry_begin[i] + 1; q < block.entry_begin[i + 1]; ++q)
        joined.unite(component[block.nodes[block.entry_node[q - 1]]], component[block.nodes[block.entry_node[q]]]);
  }
  // Of each node, the number of what it is joined to, in the order of their first components.
  std::vector<std::uint32_t> number(components, 0);
  const auto number_all = [&](std::size_t& count, std::vector<std::uint32_t>& of) {
    count = 0;
    for (std::uint32_t c = 0; c < components; ++c)
      number[c] = joined.find(c) == c ? static_cast<std::uint32_t>(count++) : number[joined.find(c)];
    for (std::size_t i = 0; i < of.size(); ++i) of[i] = number[component[i]];
  };
  number_all(pieces_, piece_);
  for (const auto& [a, b] : coupled) joined.unite(a, b);
  number_all(count_, of_);
  first_.assign(count_ + 1, 0);
  for (const auto p : of_) ++first_[p + 1];
  for (std::size_t p = 0; p < count_; ++p) first_[p + 1] += first_[p];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < of_.size(); ++i) node_[next[of_[i]]++] = i;
  block_first_.push_back(0);
  std::vector<std::uint32_t> here;
  for (std::size_t b = 0; b < of_one.size(); ++b) {
    const std::span nodes(points.blocks[b].nodes);
    here.clear();
    for (const auto j : of_one[b] ? nodes.first(std::min<std::size_t>(1, nodes.size())) : nodes)
      if (here.empty() || of_[j] != here.back()) here.push_back(of_[j]);
    std::sort(here.begin(), here.end());
    block_part_.insert(block_part_.end(), here.begin(), std::unique(here.begin(), here.end()));
    block_first_.push_back(block_part_.size());
  }
  choose(std::vector<char>(count_, 1));
}

std::size_t StepParts::slot(std::size_t block, const PointBlock& points, std::size_t point) const {
  const auto parts = of_block(block);
  if (parts.size() < 2 || points.entry_begin[point] == points.entry_begin[point + 1]) return 0;
  return static_cast<std::size_t>(
      std::lower_bound(parts.begin(), parts.end(), of_[points.nodes[points.entry_node[points.entry_begin[point]]]]) -
      parts.begin());
}

void StepParts::choose(const std::vector<char>& chosen) {
  if (chosen == chosen_) return;
  chosen_ = chosen;
  runs_.clear(), blocks_.clear(), patches_.clear(), nodes_at_work_ = 0;
  for (std::uint32_t p = 0; p < count_; ++p) {
    if (!chosen_[p]) continue;
    for (auto k = first_[p]; k < first_[p + 1]; k += most_a_run)
      runs_.push_back({p, k, std::min(k + most_a_run, first_[p + 1])});
    nodes_at_work_ += first_[p + 1] - first_[p];
  }
  for (std::uint32_t b = 0; b + 1 < block_first_.size(); ++b) {
    const auto parts = of_block(b);
    if (std::any_of(parts.begin(), parts.end(), [&](auto p) { return chosen_[p]; })) blocks_.push_back(b);
  }
  for (std::uint32_t p = 0; p < all_patches_.count(); ++p)
    if (chosen_[of_[all_patches_.nodes(p)[0]]]) patches_.push_back(p);
}

}  // namespace geo
