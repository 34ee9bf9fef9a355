// EMST ∪ k nearest, and what of it is visible (§ 6.1).
#include <algorithm>
#include <cmath>

#include "graph/nearest.h"
#include "graph/spanning_tree.h"
#include "graph/visibility.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pairs = std::vector<std::pair<NodeId, NodeId>>;

// Each pair i < j once of which one end is among the nearest of the other, or that the tree has.
Pairs candidates(const NodeSet& nodes, std::size_t k, const Progress& progress) {
  const std::size_t n = nodes.size();
  report(progress, "nearest nodes", 0, n);
  const NodeTree tree(nodes.position);
  const auto near = nearest_nodes(tree, static_cast<int>(k));
  const auto knows = [&](NodeId i, NodeId j) {
    const auto row = near.begin() + static_cast<std::ptrdiff_t>(i.index() * k);
    return std::find(row, row + static_cast<std::ptrdiff_t>(k), j) != row + static_cast<std::ptrdiff_t>(k);
  };
  constexpr std::size_t grain = 4096;
  std::vector<Pairs> parts((n + grain - 1) / grain);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t i = p * grain; i < std::min(n, (p + 1) * grain); ++i)
        for (std::size_t q = 0; q < k; ++q) {
          const NodeId a(i), b = near[i * k + q];
          if (b.valid() && (a < b || !knows(b, a))) parts[p].push_back(std::minmax(a, b));
        }
  });
  report(progress, "spanning tree", 0, n);
  std::size_t count = 0;
  for (const auto& p : parts) count += p.size();
  Pairs pairs;
  pairs.reserve(count + 64);
  for (auto& p : parts) {
    pairs.insert(pairs.end(), p.begin(), p.end());
    Pairs().swap(p);
  }
  const auto beyond = spanning_tree_beyond(tree, nodes.position, near, static_cast<int>(k));
  pairs.insert(pairs.end(), beyond.begin(), beyond.end());
  return pairs;
}

}  // namespace

VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k,
                                       const Progress& progress) {
  const std::size_t n = nodes.size();
  VisibilityGraph graph;
  graph.resize(n);
  graph.set_plain_unit(plain_unit_for(nodes));
  Pairs pairs = candidates(nodes, static_cast<std::size_t>(k), progress);

  report(progress, "visibility", 0, pairs.size());
  {
    const auto blocked = Visibility(nodes.position, obstacles).blocked(pairs);
    std::size_t kept = 0;
    for (std::size_t e = 0; e < pairs.size(); ++e)
      if (!blocked[e]) pairs[kept++] = pairs[e];
    pairs.resize(kept);
  }
  graph.edges_ = pairs.size();
  std::vector<std::uint32_t> ends(n + 1, 0);
  for (const auto& [i, j] : pairs) {
    ++ends[i.index()], ++ends[j.index()];
    graph.reach_ = std::max(graph.reach_, squared_distance(nodes.position[i.index()], nodes.position[j.index()]));
  }
  graph.reach_ = std::sqrt(graph.reach_);
  for (const double r : nodes.radius) graph.support_ = std::max(graph.support_, r);
  graph.reach_ = std::max(graph.reach_, graph.support_);
  for (std::size_t i = 0, sum = 0; i <= n; ++i) sum += ends[i], ends[i] = static_cast<std::uint32_t>(sum);
  std::vector<std::uint32_t> to(2 * pairs.size());
  for (const auto& [i, j] : pairs) to[--ends[i.index()]] = j.value, to[--ends[j.index()]] = i.value;
  Pairs().swap(pairs);
  parallel_for(n, 4096, [&](std::size_t begin, std::size_t end) {
    RowStore::Writer rows(graph.rows_);
    std::vector<std::uint16_t> bits;
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<std::uint32_t> row(to.data() + ends[i], ends[i + 1] - ends[i]);
      std::sort(row.begin(), row.end());
      bits.clear();
      for (const auto j : row)
        bits.push_back(VisibilityGraph::edge_bit | VisibilityGraph::path_bit |
                       VisibilityGraph::bits_of_bound(warped_length(nodes, i, j)));
      rows.set(i, {row, bits, {}});
    }
  });
  return graph;
}

}  // namespace geo
