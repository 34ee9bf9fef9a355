// § 6.3 and 6.4, with one departure: rows are recomputed on the whole graph. A detour between two nodes of P_update may
// leave P_update (its middle can be far from the cut while both ends are near), and the paper's subgraph would miss it.
#include "graph/update.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "graph/guides.h"
#include "graph/id_map.h"
#include "graph/row_search.h"
#include "graph/severed.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;
using ObstacleNear = std::function<void(const Box3&, std::vector<Corners>&)>;

// Whether faces lie between two nodes, for pairs that mostly have one node in common.
class PairSight {
 public:
  PairSight(const NodeSet& nodes, const VisibilityGraph& graph, const ObstacleNear& near) : nodes_(nodes), graph_(graph), near_(near), reach_(graph.reach()) {}
  bool blocked(std::uint32_t i, std::uint32_t j) {
    const Vec3 &p = graph_.position(nodes_, std::min(i, j)), &q = graph_.position(nodes_, std::max(i, j));
    Box3 segment{p, p};
    segment.add(q);
    if (known_.empty() || (segment.lo.array() < known_.lo.array()).any() || (segment.hi.array() > known_.hi.array()).any()) {
      const Vec3& middle = i < j ? p : q;
      known_ = {middle - Vec3::Constant(reach_), middle + Vec3::Constant(reach_)};
      known_.add(segment);
      triangles_.clear(), boxes_.clear();
      near_(known_, triangles_);
      for (const auto& t : triangles_) boxes_.push_back(box_of(t[0], t[1], t[2]));
    }
    for (std::size_t k = 0; k < triangles_.size(); ++k)
      if (boxes_[k].meets(segment) && segment_meets_triangle(p, q, triangles_[k][0], triangles_[k][1], triangles_[k][2])) return true;
    return false;
  }

 private:
  const NodeSet& nodes_;
  const VisibilityGraph& graph_;
  const ObstacleNear& near_;
  double reach_;
  Box3 known_;  // all triangles that meet this are here
  std::vector<Corners> triangles_;
  std::vector<Box3> boxes_;
};

// Nodes whose shortest paths may have used a cut edge, by old distances: within a support radius of an end, less the
// edge's length. Of several edges at an end the shortest decides.
// Guides have no rows of neighbours: theirs are looked for.
void add_users(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const NodePairKey> cut, RowSearch& search, IdMap& update) {
  std::vector<std::uint64_t> ends;
  for (const auto key : cut) {
    const auto i = static_cast<std::uint32_t>(key >> 32), j = static_cast<std::uint32_t>(key);
    const std::uint64_t length = graph.warped(nodes, i, j);
    ends.push_back(std::uint64_t(i) << 32 | length), ends.push_back(std::uint64_t(j) << 32 | length);
  }
  std::sort(ends.begin(), ends.end());
  const auto add_near = [&](const RowView& row, std::uint64_t length) {
    for (std::size_t k = 0; k < row.to.size(); ++k)
      if (VisibilityGraph::is_neighbor(row.bits[k]) && VisibilityGraph::bound(row.bits[k]) + length < unit_radius) update.add(row.to[k]);
  };
  std::vector<std::uint32_t> guides, lengths;
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const auto end = static_cast<std::uint32_t>(ends[e] >> 32), length = static_cast<std::uint32_t>(ends[e]);
    if (e > 0 && ends[e - 1] >> 32 == end) continue;
    if (VisibilityGraph::is_guide(end)) {
      guides.push_back(end), lengths.push_back(length);
    } else {
      update.add(end);
      add_near(graph.rows().entries(end), length);
    }
  }
  std::size_t next = 0;
  search.run(nodes, graph, guides, {}, [&](std::uint32_t, const RowView& row) { add_near(row, lengths[next++]); });
}

}  // namespace

GraphUpdate update_graph(const NodeSet& nodes, NodeId first_new, std::span<const NodeId> moved, std::span<const Corners> new_faces,
                         const ObstacleNear& obstacle_near, int k, const NodeGrid& grid, VisibilityGraph& graph,
                         std::span<const std::pair<NodeId, NodeId>> joins, const GuideChange& guides) {
  GraphUpdate result;
  thread_local RowSearch search;
  const auto& x = nodes.position;
  graph.resize(nodes.size());
  IdMap update;
  update.clear(0);

  // What the faces cut, and all that hangs on the moved nodes.
  Severed severed = find_severed(nodes, graph, grid, first_new, new_faces);
  for (const auto key : severed.neighbors) update.add(static_cast<std::uint32_t>(key >> 32)), update.add(static_cast<std::uint32_t>(key));
  for (const auto g : guides.retired)
    for (const auto j : graph.entries(g).to) severed.edges.push_back(pair_key(g, j));
  add_users(nodes, graph, severed.edges, search, update);
  for (const NodeId m : moved) {
    update.add(m.value);
    for (const auto& n : graph.neighbors(nodes, m)) update.add(n.to.value);
    const auto row = graph.entries(m.value);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      if (!VisibilityGraph::is_edge(row.bits[e])) continue;
      if (!VisibilityGraph::is_guide(row.to[e])) update.add(row.to[e]);
      severed.edges.push_back(pair_key(m.value, row.to[e]));
    }
  }
  std::sort(severed.edges.begin(), severed.edges.end());
  for (const auto key : severed.edges)
    if (const NodeId i(static_cast<std::uint32_t>(key >> 32)), j(static_cast<std::uint32_t>(key)); graph.remove(i, j) && !VisibilityGraph::is_guide(j.value)) result.cut_edges.push_back({i, j});

  // E_new: each new node's k nearest visible nodes. The nearest are asked in growing numbers, since many may be hidden.
  const auto old_guides = VisibilityGraph::first_guide + graph.guides().size();
  for (const auto g : guides.retired) graph.retire_guide(g);
  for (const Guide& guide : guides.added) graph.add_guide(guide);
  PairSight sight(nodes, graph, obstacle_near);
  std::vector<std::uint32_t> fresh;
  for (const NodeId m : moved) fresh.push_back(m.value);
  for (std::uint32_t i = first_new.value; i < nodes.size(); ++i) fresh.push_back(i);
  std::vector<std::uint32_t> seen_guides;
  const auto join = [&](NodeId i, NodeId j) {
    if (graph.add(nodes, i, j)) result.added_edges.push_back(std::minmax(i, j));
  };
  for (const auto i : fresh) {
    int seen = 0;
    for (const auto j : grid.nearest(x, x[i], static_cast<std::size_t>(3 * k), i, [](auto) { return true; })) {
      if (seen == k) break;
      if (sight.blocked(i, j)) continue;
      ++seen;
      join(NodeId(i), NodeId(j));
    }
    seen_guides.clear();
    guides_near(nodes, graph, i, seen_guides);
    for (const auto g : seen_guides)
      if (g < old_guides && !sight.blocked(i, g)) graph.add(nodes, NodeId(i), NodeId(g));
  }
  std::vector<std::vector<std::uint32_t>> seen(guides.added.size());
  for (std::size_t g = 0; g < seen.size(); ++g) {
    const auto id = static_cast<std::uint32_t>(old_guides + g);
    near_guide(nodes, grid, graph, id, seen[g]);
    std::erase_if(seen[g], [&](std::uint32_t other) { return sight.blocked(id, other); });
  }
  join_guides(nodes, seen, graph);
  std::sort(fresh.begin(), fresh.end());
  std::vector<std::uint32_t> beginnings = fresh;
  for (const auto& [a, b] : joins) {
    join(a, b);
    beginnings.insert(beginnings.end(), {a.value, b.value});  // an old node that gains an edge is a new beginning, too
  }
  for (std::size_t g = 0; g < guides.added.size(); ++g) beginnings.push_back(static_cast<std::uint32_t>(old_guides + g));
  std::sort(beginnings.begin(), beginnings.end());
  beginnings.erase(std::unique(beginnings.begin(), beginnings.end()), beginnings.end());
  std::sort(result.added_edges.begin(), result.added_edges.end());

  // P_update, complete with everyone to whom a new edge may be a short cut.
  const auto add = [&](std::uint32_t id) {
    if (!VisibilityGraph::is_guide(id)) update.add(id);
  };
  search.run(nodes, graph, beginnings, {}, [&](std::uint32_t i, const RowView& row) {
    add(i);
    for (const auto j : row.to) add(j);
  });
  std::vector<std::uint32_t> sources = update.ids();
  std::sort(sources.begin(), sources.end());

  // Who saw each other goes on doing so unless a new face came between them. Who did not is asked again: faces that were
  // divided have rounded corners, and a segment that only just touched one may pass now.
  std::vector<NodePairKey> hidden = severed.neighbors;  // from both ends
  for (const auto key : severed.neighbors) hidden.push_back(key << 32 | key >> 32);
  std::sort(hidden.begin(), hidden.end());
  std::size_t next_hidden = 0;
  const auto is_fresh = [&](std::uint32_t i) { return i >= first_new.value || (!moved.empty() && std::binary_search(fresh.begin(), fresh.end(), i)); };
  const auto mark_hidden = [&](std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits) {
    while (next_hidden < hidden.size() && hidden[next_hidden] >> 32 < i) ++next_hidden;
    const auto old = graph.rows().entries(i);
    const bool fresh_i = is_fresh(i);
    for (std::size_t e = 0, o = 0; e < to.size(); ++e) {
      if (VisibilityGraph::is_edge(bits[e])) continue;
      const auto key = NodePairKey(i) << 32 | to[e];
      while (o < old.to.size() && old.to[o] < to[e]) ++o;
      while (next_hidden < hidden.size() && hidden[next_hidden] < key) ++next_hidden;
      const bool saw = !fresh_i && o < old.to.size() && old.to[o] == to[e] && VisibilityGraph::is_neighbor(old.bits[o]) &&
                       !RowStore::has_path(old.bits[o]) && !is_fresh(to[e]);
      const bool is_hidden = saw ? next_hidden < hidden.size() && hidden[next_hidden] == key : sight.blocked(i, to[e]);
      if (is_hidden) bits[e] |= VisibilityGraph::path_bit;
    }
  };
  search.run(nodes, graph, sources, mark_hidden, [&](std::uint32_t i, const RowView& row) { graph.set_neighbors(NodeId(i), row); });
  for (const auto i : sources) result.updated_nodes.push_back(NodeId(i));
  return result;
}

}  // namespace geo
