#include "graph/visibility_graph.h"

#include <algorithm>
#include <cmath>

#include "graph/nearest.h"
#include "graph/spanning_tree.h"
#include "graph/visibility.h"

namespace geo {

std::uint32_t warped_length(const Vec3& xi, const Vec3& xj, double ri, double rj) {
  const double d = (xi - xj).norm() / std::max(ri, rj) * double(unit_radius);
  return static_cast<std::uint32_t>(std::clamp(std::ceil(d), 1.0, 1073741824.0));
}

double plain_unit_for(const NodeSet& nodes) {
  const double most = nodes.size() == 0 ? 1.0 : *std::max_element(nodes.radius.begin(), nodes.radius.end());
  return std::exp2(std::ceil(std::log2(most)) - 26);
}

bool VisibilityGraph::has(NodeId i, NodeId j) const {
  return std::any_of(rows_[i.index()].begin(), rows_[i.index()].end(), [&](const Arc& a) { return a.to == j; });
}

bool VisibilityGraph::add(const NodeSet& nodes, NodeId i, NodeId j) {
  if (has(i, j)) return false;
  const auto length = warped_length(nodes.position[i.index()], nodes.position[j.index()], nodes.radius[i.index()], nodes.radius[j.index()]);
  const double distance = (nodes.position[i.index()] - nodes.position[j.index()]).norm();
  const auto plain = static_cast<std::uint32_t>(std::clamp(std::ceil(distance / plain_unit_), 1.0, 1073741824.0));
  const auto put = [&](NodeId from, NodeId to) {
    auto& row = rows_[from.index()];
    const Arc arc{to, length, plain};
    const auto less = [](const Arc& a, const Arc& b) { return a.length != b.length ? a.length < b.length : a.to < b.to; };
    row.insert(std::upper_bound(row.begin(), row.end(), arc, less), arc);
  };
  put(i, j), put(j, i);
  longest_ = std::max(longest_, distance);
  ++edges_;
  return true;
}

bool VisibilityGraph::remove(NodeId i, NodeId j) {
  const auto take = [&](NodeId from, NodeId to) { return std::erase_if(rows_[from.index()], [&](const Arc& a) { return a.to == to; }) > 0; };
  if (!take(i, j)) return false;
  take(j, i);
  --edges_;
  return true;
}

std::uint32_t VisibilityGraph::components(std::vector<std::uint32_t>& of) const {
  of.assign(rows_.size(), ~0u);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    if (of[i] != ~0u) continue;
    of[i] = count;
    stack.push_back(i);
    while (!stack.empty()) {
      const auto at = stack.back();
      stack.pop_back();
      for (const Arc& a : rows_[at])
        if (of[a.to.index()] == ~0u) of[a.to.index()] = count, stack.push_back(a.to.value);
    }
    ++count;
  }
  return count;
}

VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k, const Progress& progress) {
  const std::size_t n = nodes.size();
  VisibilityGraph graph;
  graph.resize(n);
  graph.set_plain_unit(plain_unit_for(nodes));
  report(progress, "nearest nodes", 0, n);
  const NodeTree tree(nodes.position);
  const auto near = nearest_nodes(tree, k);
  std::vector<std::pair<NodeId, NodeId>> edges;
  for (std::uint32_t i = 0; i < n; ++i)
    for (int q = 0; q < k; ++q)
      if (const NodeId j = near[i * static_cast<std::size_t>(k) + static_cast<std::size_t>(q)]; j.valid()) edges.push_back(std::minmax(NodeId(i), j));
  report(progress, "spanning tree", 0, n);
  const auto beyond = spanning_tree_beyond(tree, nodes.position, near, k);
  edges.insert(edges.end(), beyond.begin(), beyond.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  report(progress, "visibility", 0, edges.size());
  const auto blocked = Visibility(nodes.position, obstacles).blocked(edges);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (!blocked[e]) graph.add(nodes, edges[e].first, edges[e].second);
  return graph;
}

}  // namespace geo
