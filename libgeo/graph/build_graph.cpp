// The visibility graph of § 6.1: spanning tree ∪ k nearest nodes, without edges that a face blocks.
#include <algorithm>

#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/nearest.h"
#include "graph/spanning_tree.h"
#include "graph/visibility.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pairs = std::vector<std::pair<NodeId, NodeId>>;

// Pairs i < j, each once: i is among the k nearest of j, or j among the k nearest of i, or the
// spanning tree joins them.
Pairs candidate_edges(const NodeSet& nodes, std::size_t k, const Progress& progress) {
  const std::size_t n = nodes.size();
  report(progress, "nearest nodes", 0, n);
  const NodeTree tree(nodes.position);
  const auto near = nearest_nodes(tree, static_cast<int>(k));
  const auto is_near = [&](NodeId i, NodeId j) {
    const auto row = near.begin() + static_cast<std::ptrdiff_t>(i.index() * k);
    return std::find(row, row + static_cast<std::ptrdiff_t>(k), j) != row + static_cast<std::ptrdiff_t>(k);
  };
  // Nodes of a task; the pairs do not depend on it.
  constexpr std::size_t grain = 4096;
  std::vector<Pairs> chunks((n + grain - 1) / grain);
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t i = c * grain; i < std::min(n, (c + 1) * grain); ++i)
        for (std::size_t q = 0; q < k; ++q) {
          const NodeId a(i), b = near[i * k + q];
          if (b.valid() && (a < b || !is_near(b, a))) chunks[c].push_back(std::minmax(a, b));
        }
  });
  report(progress, "spanning tree", 0, n);
  std::size_t count = 0;
  for (const auto& chunk : chunks) count += chunk.size();
  Pairs pairs;
  pairs.reserve(count + 64);
  for (auto& chunk : chunks) {
    pairs.insert(pairs.end(), chunk.begin(), chunk.end());
    Pairs().swap(chunk);
  }
  const auto tree_edges = spanning_tree_beyond(tree, nodes.position, near, static_cast<int>(k));
  pairs.insert(pairs.end(), tree_edges.begin(), tree_edges.end());
  return pairs;
}

}  // namespace

VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k,
                                       const Progress& progress) {
  Pairs pairs = candidate_edges(nodes, static_cast<std::size_t>(k), progress);
  report(progress, "visibility", 0, pairs.size());
  {
    const auto blocked = Visibility(nodes.position, obstacles).blocked(pairs);
    std::size_t kept = 0;
    for (std::size_t e = 0; e < pairs.size(); ++e)
      if (!blocked[e]) pairs[kept++] = pairs[e];
    pairs.resize(kept);
  }
  VisibilityGraph graph;
  GraphStorage::of(graph) = GraphStorage::from_edges(nodes, std::move(pairs));
  return graph;
}

VisibilityGraph build_visibility_graph(const NodeSet& nodes, std::span<const std::array<Vec3, 3>> obstacles, int k,
                                       const Progress& progress) {
  return build_visibility_graph(nodes, TriangleBvh(obstacles), k, progress);
}

}  // namespace geo
