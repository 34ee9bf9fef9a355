// Borůvka's algorithm: in each round, the shortest edge out of each component.
//
// A node's k nearest nodes are tested first. If none of them is in another component, the tree of
// nodes is searched. It is not if the component has an edge shorter than the distance to the k-th.
// For edges beyond the nearest nodes, everything joined by edges shorter than any node's k-th
// nearest counts as one component from the start. Where nodes are spread evenly that is all nodes,
// and no round is left.
#include "graph/spanning_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "graph/nearest.h"

namespace geo {
namespace {

constexpr std::uint32_t none = ~0u;

struct TreeEdge {
  double square = std::numeric_limits<double>::infinity();
  std::uint32_t i = none, j = none;
  bool operator<(const TreeEdge& o) const {
    return square != o.square ? square < o.square : i != o.i ? i < o.i : j < o.j;
  }
};

class Boruvka {
 public:
  Boruvka(const NodeTree& tree, std::span<const Vec3> positions, std::span<const NodeId> near, int k)
      : tree_(tree),
        x_(positions),
        near_(near),
        k_(static_cast<std::size_t>(k)),
        component_(positions.size()),
        components_(positions.size()) {
    std::iota(component_.begin(), component_.end(), 0u);
  }

  // Joins along edges to nearest nodes that are shorter than the distance of every node to its k-th
  // nearest. Both ends have such an edge, and the tree has all other pairs later.
  void join_nearest() {
    if (k_ == 0) return;
    double reach = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < x_.size(); ++i)
      if (const auto last = near(i, k_ - 1); last.valid()) reach = std::min(reach, square(i, last.value));
    constexpr std::size_t few = 8;  // mostly join all
    for (std::size_t first = 0; first < k_ && components_ > 1; first += first == 0 ? few : k_)
      for (std::uint32_t i = 0; i < x_.size(); ++i)
        for (std::size_t q = first; q < (first == 0 ? std::min(few, k_) : k_); ++q) {
          const auto j = near(i, q);
          if (!j.valid() || !(square(i, j.value) < reach)) break;
          if (j.value < i) join(i, j.value);
        }
    for (std::uint32_t i = 0; i < x_.size(); ++i) component_[i] = component_[component_[i]];
  }

  std::vector<TreeEdge> run() {
    std::vector<TreeEdge> edges;
    if (components_ > 1) {
      best_.resize(x_.size());
      tested_.resize(x_.size(), 0);
    }
    while (components_ > 1) {
      std::fill(best_.begin(), best_.end(), TreeEdge());
      for (std::uint32_t i = 0; i < x_.size(); ++i) offer_nearest(i);
      search();
      for (std::uint32_t c = 0; c < best_.size(); ++c) {
        const TreeEdge& edge = best_[c];
        if (edge.i == none) continue;
        if (join(edge.i, edge.j)) edges.push_back(edge);
      }
      for (std::uint32_t i = 0; i < x_.size(); ++i) component_[i] = component_[component_[i]];  // roots come first
    }
    return edges;
  }

 private:
  NodeId near(std::uint32_t i, std::size_t q) const { return near_[i * k_ + q]; }
  double square(std::uint32_t i, std::uint32_t j) const { return squared_distance(x_[i], x_[j]); }
  std::uint32_t find(std::uint32_t v) {
    while (component_[v] != v) v = component_[v] = component_[component_[v]];
    return v;
  }
  bool join(std::uint32_t i, std::uint32_t j) {
    const auto a = find(i), b = find(j);
    if (a == b) return false;
    component_[std::max(a, b)] = std::min(a, b);
    --components_;
    return true;
  }
  void offer(std::uint32_t i, std::uint32_t j) {
    TreeEdge& edge = best_[component_[i]];
    edge = std::min(edge, TreeEdge{square(i, j), std::min(i, j), std::max(i, j)});
  }

  // Nodes of one component stay in it, so the list of nearest nodes is read once.
  void offer_nearest(std::uint32_t i) {
    auto& q = tested_[i];
    while (q < k_ && near(i, q).valid() && component_[near(i, q).index()] == component_[i]) ++q;
    if (q < k_ && near(i, q).valid()) offer(i, near(i, q).value);
  }

  // Searches from nodes whose nearest nodes are all in their component, where the result may be the
  // shortest.
  void search() {
    cell_component_.clear();
    for (const auto i : tree_.nodes()) {
      if (tested_[i] < k_) continue;  // its list has an edge out, or holds all nodes
      if (k_ > 0 && square(i, near(i, k_ - 1).value) > best_[component_[i]].square) continue;
      if (cell_component_.empty()) label_cells();
      search(0, i);
    }
  }

  // The component of all nodes of a cell, or none.
  void label_cells() {
    const auto cells = tree_.cells();
    cell_component_.resize(cells.size());
    for (std::size_t c = cells.size(); c-- > 0;) {
      if (!cells[c].leaf()) {
        const auto l = cell_component_[cells[c].children], r = cell_component_[cells[c].children + 1];
        cell_component_[c] = l == r ? l : none;
        continue;
      }
      cell_component_[c] = component_[tree_.nodes()[cells[c].begin]];
      for (auto slot = cells[c].begin; slot < cells[c].end; ++slot)
        if (component_[tree_.nodes()[slot]] != cell_component_[c]) cell_component_[c] = none;
    }
  }

  void search(std::uint32_t at, std::uint32_t i) {
    const auto cells = tree_.cells();
    if (cell_component_[at] == component_[i]) return;
    if (cells[at].leaf()) {
      for (auto slot = cells[at].begin; slot < cells[at].end; ++slot)
        if (const auto j = tree_.nodes()[slot]; component_[j] != component_[i]) offer(i, j);
      return;
    }
    const auto l = cells[at].children, r = l + 1;
    const double to_l = cells[l].gap(x_[i].data(), x_[i].data()), to_r = cells[r].gap(x_[i].data(), x_[i].data());
    const double& reach = best_[component_[i]].square;
    for (const bool left : {to_l <= to_r, to_l > to_r})
      if ((left ? to_l : to_r) <= reach) search(left ? l : r, i);
  }

  const NodeTree& tree_;
  std::span<const Vec3> x_;
  std::span<const NodeId> near_;
  const std::size_t k_;
  std::vector<std::uint32_t> component_;  // of each node: the lowest node of its component, between rounds
  std::size_t components_;                // their number
  std::vector<TreeEdge> best_;            // of each component, by its lowest node
  std::vector<std::uint32_t> tested_;     // number of its nearest nodes known to be in its component
  std::vector<std::uint32_t> cell_component_;
};

std::vector<std::pair<NodeId, NodeId>> as_pairs(const std::vector<TreeEdge>& edges) {
  std::vector<std::pair<NodeId, NodeId>> pairs;
  for (const TreeEdge& e : edges) pairs.push_back({NodeId(e.i), NodeId(e.j)});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions) {
  // Nearest nodes tested before the tree is searched; the result does not depend on their number.
  constexpr int k = 8;
  const NodeTree tree(positions);
  const auto near = nearest_nodes(tree, k);
  return as_pairs(Boruvka(tree, positions, near, k).run());
}

std::vector<std::pair<NodeId, NodeId>> spanning_tree_beyond(const NodeTree& tree, std::span<const Vec3> positions,
                                                            std::span<const NodeId> near, int k) {
  Boruvka boruvka(tree, positions, near, k);
  boruvka.join_nearest();
  auto edges = boruvka.run();
  const auto length = static_cast<std::size_t>(k);
  const auto has = [&](std::uint32_t i, std::uint32_t j) {
    const auto row = near.subspan(i * length, length);
    return std::find(row.begin(), row.end(), NodeId(j)) != row.end();
  };
  std::erase_if(edges, [&](const TreeEdge& e) { return has(e.i, e.j) || has(e.j, e.i); });
  return as_pairs(edges);
}

}  // namespace geo
