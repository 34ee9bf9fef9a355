// A bisection tree over a cube about the origin, halved at its centre along x, y, z in turn. Each
// leaf's connected sets are cores; outer products are summed per block of points, then over blocks
// in order.
#include "mechanics/solver/subdomains.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "kerf/parallel.h"
#include "mechanics/solver/subdomain_lanes.h"

namespace geo {
namespace {

// Measured (docs/decisions/043): to a hundredth of the residual, an overlap of 1.1 takes 11
// iterations in place of 15, and three and a half times the memory.
constexpr std::size_t max_in_leaf = 6;
constexpr double overlap = 0.9;  // spacings
constexpr int max_depth = 180;   // 60 halvings of each axis: nodes closer together share a leaf

// The count of numbers in the outer products of a subdomain.
std::size_t outer_size(std::size_t nodes) { return 12 * (nodes * (nodes + 1) / 2); }

using Leaves = std::vector<std::span<std::uint32_t>>;  // the nodes of each

// Halves a box, one axis after another, until at most `max_in_leaf` nodes are left in each part.
// The result depends on no node outside the box.
void divide(const std::vector<Vec3>& position, std::span<std::uint32_t> nodes, const Vec3& centre, const Vec3& half,
            int depth, Leaves& leaves) {
  constexpr std::size_t worth_a_thread = 2048;  // nodes
  if (nodes.empty()) return;
  if (nodes.size() <= max_in_leaf || depth == max_depth) return leaves.push_back(nodes);
  const int axis = depth % 3;
  const auto upper =
      std::partition(nodes.begin(), nodes.end(), [&](auto i) { return position[i][axis] < centre[axis]; });
  const auto below = static_cast<std::size_t>(upper - nodes.begin());
  Vec3 quarter = half;
  quarter[axis] *= 0.5;
  const Vec3 step = quarter[axis] * Vec3::Unit(axis);
  const auto divide_lower = [&](Leaves& out) {
    divide(position, nodes.first(below), centre - step, quarter, depth + 1, out);
  };
  const auto divide_upper = [&](Leaves& out) {
    divide(position, nodes.subspan(below), centre + step, quarter, depth + 1, out);
  };
  if (nodes.size() < worth_a_thread) {
    divide_lower(leaves);
    return divide_upper(leaves);
  }
  Leaves upper_leaves;
  parallel_invoke([&] { divide_lower(leaves); }, [&] { divide_upper(upper_leaves); });
  leaves.insert(leaves.end(), upper_leaves.begin(), upper_leaves.end());
}

// Leaves of a cube about the origin that holds all nodes; its size is a power of two, so that a cut
// moves no face of it.
Leaves leaves_of(const std::vector<Vec3>& position, std::span<std::uint32_t> nodes) {
  double farthest = 0;
  for (const Vec3& x : position) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  Leaves leaves;
  divide(position, nodes, Vec3::Zero(), Vec3::Constant(std::exp2(std::ceil(std::log2(farthest)) + 1)), 0, leaves);
  return leaves;
}

// The subdomains of a leaf: its connected sets of nodes, each with overlap. `nodes`: the leaf's,
// ascending; `box`: per node, its leaf; `visited`: per node, 0 before and 1 after.
std::vector<std::vector<std::uint32_t>> subdomains_in(const SubdomainInput& input, std::span<const std::uint32_t> nodes,
                                                      const std::vector<std::uint32_t>& box,
                                                      std::vector<char>& visited) {
  std::vector<std::vector<std::uint32_t>> subdomains;
  std::vector<std::uint32_t> core;
  for (const auto i : nodes) {
    if (visited[i]) continue;
    visited[i] = 1;
    core.assign(1, i);
    for (std::size_t k = 0; k < core.size(); ++k)
      for (const auto j : input.mls[core[k]].neighbors)
        if (box[j] == box[i] && !std::exchange(visited[j], 1)) core.push_back(j);
    auto& subdomain = subdomains.emplace_back(core);
    for (const auto o : core) {
      const auto& stencil = input.mls[o];
      for (std::size_t q = 0; q < stencil.neighbors.size(); ++q)
        if (const auto j = stencil.neighbors[q];
            stencil.offset[q].norm() < overlap * std::min(input.spacing[o], input.spacing[j]))
          subdomain.push_back(j);
    }
    std::sort(subdomain.begin(), subdomain.end());
    subdomain.erase(std::unique(subdomain.begin(), subdomain.end()), subdomain.end());
  }
  return subdomains;
}

}  // namespace

Subdomains::Subdomains(const SubdomainInput& input) {
  list(input);
  sum_points(input.points, std::vector<char>(count(), 1));
}

std::vector<std::uint32_t> Subdomains::update(const SubdomainInput& input, const std::vector<char>& changed,
                                              const PointChanges& changes) {
  Subdomains before = std::move(*this);
  *this = Subdomains();
  list(input, &before, &changed);
  std::vector<char> stale(count(), 1);
  std::vector<std::uint32_t> former(count(), ~0u);
  for (std::size_t p = 0; p < count(); ++p) {
    const auto now = nodes(p);
    if (now[0] + 1 >= before.begin_.size() ||
        std::any_of(now.begin(), now.end(), [&](auto i) { return changes.node_changed[i]; }))
      continue;
    for (const Incidence& at : before.subdomains_of(now[0])) {
      const auto was = before.nodes(at.subdomain);
      if (before.outer_[at.subdomain].empty() || !std::equal(now.begin(), now.end(), was.begin(), was.end())) continue;
      outer_[p] = std::move(before.outer_[at.subdomain]);
      point_[p] = before.point_[at.subdomain];
      stale[p] = 0;
      former[p] = at.subdomain;
      if (point_[p].first != ~0u) point_[p].first = changes.new_block[point_[p].first];
      break;
    }
  }
  sum_points(input.points, stale);
  return former;
}

void Subdomains::list(const SubdomainInput& input, const Subdomains* before, const std::vector<char>* changed) {
  NodeLists all;
  for (NodeLists& of_box : lists_of_boxes(input, before, changed)) {
    first_of_box_.push_back(static_cast<std::uint32_t>(all.size()));
    std::move(of_box.begin(), of_box.end(), std::back_inserter(all));
  }
  first_of_box_.push_back(static_cast<std::uint32_t>(all.size()));
  index(all, input.position.size());
  outer_.resize(count());
  point_.assign(count(), {~0u, 0});
}

// The node lists of the subdomains of each leaf. A leaf with the same nodes as before, none of them
// changed, has the same subdomains.
std::vector<Subdomains::NodeLists> Subdomains::lists_of_boxes(const SubdomainInput& input, const Subdomains* before,
                                                              const std::vector<char>* changed) {
  const std::size_t n = input.position.size();
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0);
  const Leaves leaves = leaves_of(input.position, all);
  box_.resize(n);
  for (std::uint32_t b = 0; b < leaves.size(); ++b)
    for (const auto i : leaves[b]) box_[i] = b;
  std::vector<std::uint32_t> size_before(before ? before->first_of_box_.size() : 0, 0);  // per leaf, in nodes
  if (before)
    for (const auto b : before->box_) ++size_before[b];
  const auto is_same = [&](std::span<const std::uint32_t> nodes) {
    if (!before || nodes[0] >= before->box_.size() || size_before[before->box_[nodes[0]]] != nodes.size()) return false;
    return std::all_of(nodes.begin(), nodes.end(), [&](auto i) {
      return i < before->box_.size() && before->box_[i] == before->box_[nodes[0]] && !(*changed)[i];
    });
  };
  std::vector<NodeLists> lists(leaves.size());
  std::vector<char> visited(n, 0);
  parallel_for(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (is_same(leaves[b])) {
        const auto was = before->box_[leaves[b][0]];
        for (auto p = before->first_of_box_[was]; p < before->first_of_box_[was + 1]; ++p)
          lists[b].emplace_back(before->nodes(p).begin(), before->nodes(p).end());
      } else {
        std::sort(leaves[b].begin(), leaves[b].end());
        lists[b] = subdomains_in(input, leaves[b], box_, visited);
      }
    }
  });
  return lists;
}

void Subdomains::index(const NodeLists& nodes, std::size_t node_count) {
  begin_.assign(node_count + 1, 0);
  for (const auto& own : nodes) {
    node_.insert(node_.end(), own.begin(), own.end());
    first_.push_back(node_.size());
    for (const auto i : own) ++begin_[i + 1];
  }
  for (std::size_t i = 0; i < node_count; ++i) begin_[i + 1] += begin_[i];
  incidence_.resize(node_.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t p = 0; p < nodes.size(); ++p)
    for (std::uint32_t s = 0; s < nodes[p].size(); ++s) incidence_[next[nodes[p][s]]++] = {p, s};
}

// The wanted subdomains that nodes of a block belong to, ascending.
std::vector<std::uint32_t> Subdomains::subdomains_at(const PointBlock& block, const std::vector<char>& wanted) const {
  std::vector<std::uint32_t> found;
  for (const auto j : block.nodes)
    for (const Incidence& at : subdomains_of(j))
      if (wanted[at.subdomain]) found.push_back(at.subdomain);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

// The sums of a block's points for some subdomains, ascending.
BlockOuterProducts Subdomains::sum_block(const PointBlock& block, std::span<const std::uint32_t> subdomains) const {
  BlockOuterProducts sums;
  sums.subdomains.assign(subdomains.begin(), subdomains.end());
  sums.first.assign(1, 0);
  for (const auto p : subdomains) sums.first.push_back(sums.first.back() + outer_size(nodes(p).size()));
  sums.outer.assign(sums.first.back(), 0);
  sums.best_point.assign(subdomains.size(), {0, 0});
  std::vector<std::uint32_t> first(1, 0);
  std::vector<Incidence> places;  // per node of the block: indices into sums.subdomains, and slots
  for (const auto j : block.nodes) {
    for (const Incidence& at : subdomains_of(j))
      if (const auto found = std::lower_bound(subdomains.begin(), subdomains.end(), at.subdomain);
          found != subdomains.end() && *found == at.subdomain)
        places.push_back({static_cast<std::uint32_t>(found - subdomains.begin()), at.slot});
    first.push_back(static_cast<std::uint32_t>(places.size()));
  }
  add_outer_products(block, first, places, sums);
  return sums;
}

// For the wanted subdomains: the sums of each block's points, then the sum over blocks in their
// order. A small body has few blocks, so that a block's subdomains are divided among threads.
void Subdomains::sum_points(const MaterialPoints& points, const std::vector<char>& wanted) {
  constexpr std::size_t subdomains_per_task = 32;
  struct Task {
    std::uint32_t block;
    std::size_t begin, end;  // of the block's subdomains
  };
  std::vector<std::vector<std::uint32_t>> at_block(points.blocks.size());
  parallel_for(at_block.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) at_block[b] = subdomains_at(points.blocks[b], wanted);
  });
  std::vector<Task> tasks;
  for (std::uint32_t b = 0; b < at_block.size(); ++b)
    for (std::size_t k = 0; k < at_block[b].size(); k += subdomains_per_task)
      tasks.push_back({b, k, std::min(k + subdomains_per_task, at_block[b].size())});
  std::vector<BlockOuterProducts> block_sums(tasks.size());
  parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [block, from, to] = tasks[t];
      block_sums[t] = sum_block(points.blocks[block], std::span(at_block[block]).subspan(from, to - from));
    }
  });
  using Source = std::pair<std::uint32_t, std::uint32_t>;  // task, and index of the subdomain there
  std::vector<std::vector<Source>> sources(count());
  for (std::uint32_t t = 0; t < tasks.size(); ++t)
    for (std::uint32_t k = 0; k < block_sums[t].subdomains.size(); ++k)
      sources[block_sums[t].subdomains[k]].push_back({t, k});
  parallel_for(count(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (!wanted[p]) continue;
      outer_[p].assign(outer_size(nodes(p).size()), 0);
      std::uint32_t max_nodes = 0;
      for (const auto& [t, k] : sources[p]) {
        const BlockOuterProducts& sums = block_sums[t];
        for (std::size_t i = 0; i < outer_[p].size(); ++i) outer_[p][i] += sums.outer[sums.first[k] + i];
        if (sums.best_point[k].nodes > max_nodes) {
          max_nodes = sums.best_point[k].nodes;
          point_[p] = {tasks[t].block, sums.best_point[k].point};
        }
      }
      for (std::size_t i = 3; i < outer_[p].size(); i += 4) outer_[p][i] = 0;
    }
  });
}

}  // namespace geo
