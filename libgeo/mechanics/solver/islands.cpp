// Union–find over the components of the graph: shared material points give the free-floating
// islands, contact on top of them the islands.
#include "mechanics/solver/islands.h"

#include "base/union_find.h"
#include "kerf/parallel.h"

namespace geo {

Islands::Islands(const MaterialPoints& points, const std::vector<std::uint32_t>& component, std::uint32_t components,
                 std::span<const std::pair<std::uint32_t, std::uint32_t>> coupled)
    : of_(component.size(), 0), free_of_(of_), node_(component.size()) {
  UnionFind joined(components);
  std::vector<char> has_one_component(points.blocks.size());
  parallel_for(has_one_component.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto& nodes = points.blocks[b].nodes;
      has_one_component[b] =
          std::all_of(nodes.begin(), nodes.end(), [&](auto j) { return component[j] == component[nodes[0]]; });
    }
  });
  // A point may see nodes that no path of the graph joins.
  for (std::size_t b = 0; b < has_one_component.size(); ++b) {
    const PointBlock& block = points.blocks[b];
    if (has_one_component[b]) continue;
    for (std::size_t i = 0; i < block.points.size(); ++i)
      for (auto q = block.entry_begin[i] + 1; q < block.entry_begin[i + 1]; ++q)
        joined.unite(component[block.nodes[block.entry_node[q - 1]]], component[block.nodes[block.entry_node[q]]]);
  }
  // Sets of joined components are numbered in the order of their first components.
  std::vector<std::uint32_t> number(components, 0);
  const auto number_sets = [&](std::size_t& count, std::vector<std::uint32_t>& of_node) {
    count = 0;
    for (std::uint32_t c = 0; c < components; ++c)
      number[c] = joined.find(c) == c ? static_cast<std::uint32_t>(count++) : number[joined.find(c)];
    for (std::size_t i = 0; i < of_node.size(); ++i) of_node[i] = number[component[i]];
  };
  number_sets(free_count_, free_of_);
  for (const auto& [a, b] : coupled) joined.unite(a, b);
  number_sets(count_, of_);
  first_.assign(count_ + 1, 0);
  for (const auto p : of_) ++first_[p + 1];
  for (std::size_t p = 0; p < count_; ++p) first_[p + 1] += first_[p];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < of_.size(); ++i) node_[next[of_[i]]++] = i;
  block_first_.push_back(0);
  std::vector<std::uint32_t> here;
  for (std::size_t b = 0; b < has_one_component.size(); ++b) {
    const std::span nodes(points.blocks[b].nodes);
    here.clear();
    for (const auto j : has_one_component[b] ? nodes.first(std::min<std::size_t>(1, nodes.size())) : nodes)
      if (here.empty() || of_[j] != here.back()) here.push_back(of_[j]);
    std::sort(here.begin(), here.end());
    block_island_.insert(block_island_.end(), here.begin(), std::unique(here.begin(), here.end()));
    block_first_.push_back(block_island_.size());
  }
}

std::size_t Islands::slot(std::size_t block, const PointBlock& points, std::size_t point) const {
  const auto islands = of_block(block);
  if (islands.size() < 2 || points.entry_begin[point] == points.entry_begin[point + 1]) return 0;
  return static_cast<std::size_t>(std::lower_bound(islands.begin(), islands.end(),
                                                   of_[points.nodes[points.entry_node[points.entry_begin[point]]]]) -
                                  islands.begin());
}

ActiveIslands::ActiveIslands(const Islands& islands, const Subdomains& subdomains)
    : islands_(islands), all_subdomains_(subdomains) {
  select(std::vector<char>(islands.count(), 1));
}

void ActiveIslands::select(const std::vector<char>& mask) {
  constexpr std::size_t nodes_per_run = 512;  // a few microseconds of work, and enough runs for all threads
  if (mask == mask_) return;
  mask_ = mask;
  runs_.clear();
  blocks_.clear();
  active_subdomains_.clear();
  node_count_ = 0;
  for (std::uint32_t p = 0; p < islands_.count(); ++p) {
    if (!mask_[p]) continue;
    const auto nodes = islands_.nodes(p);
    for (std::size_t k = 0; k < nodes.size(); k += nodes_per_run)
      runs_.push_back({p, nodes.subspan(k, std::min(nodes_per_run, nodes.size() - k))});
    node_count_ += nodes.size();
  }
  for (std::uint32_t b = 0; b < islands_.block_count(); ++b) {
    const auto islands = islands_.of_block(b);
    if (std::any_of(islands.begin(), islands.end(), [&](auto p) { return mask_[p]; })) blocks_.push_back(b);
  }
  for (std::uint32_t p = 0; p < all_subdomains_.count(); ++p)
    if (mask_[islands_.of(all_subdomains_.nodes(p)[0])]) active_subdomains_.push_back(p);
}

}  // namespace geo
