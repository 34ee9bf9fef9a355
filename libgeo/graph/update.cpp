// § 6.3 and 6.4, with one departure: rows are recomputed on the whole graph. A detour between two nodes of P_update may
// leave P_update (its middle can be far from the cut while both ends are near), and the paper's subgraph would miss it.
#include "graph/update.h"

#include <algorithm>
#include <utility>

#include "geometry/predicates.h"
#include "graph/guides.h"
#include "graph/id_flags.h"
#include "graph/lane_search.h"
#include "graph/nearest_seen.h"
#include "graph/old_sight.h"
#include "graph/row_search.h"
#include "graph/severed.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;
using ObstacleNear = std::function<void(const Box3&, std::vector<Corners>&)>;

// Whether faces lie between two nodes, for pairs that mostly have one node in common: faces are read around it, not
// farther than there are few.
class PairSight {
 public:
  PairSight(const NodeSet& nodes, const VisibilityGraph& graph, const ObstacleNear& near)
      : nodes_(nodes), graph_(graph), near_(near), most_(graph.reach()), reach_(most_) {}
  bool blocked(std::uint32_t i, std::uint32_t j) {
    const Vec3 &p = graph_.position(nodes_, std::min(i, j)), &q = graph_.position(nodes_, std::max(i, j));
    Box3 segment{p, p};
    segment.add(q);
    if (known_.empty() || (segment.lo.array() < known_.lo.array()).any() ||
        (segment.hi.array() > known_.hi.array()).any()) {
      const Vec3& middle = i < j ? p : q;
      known_ = {middle - Vec3::Constant(reach_), middle + Vec3::Constant(reach_)};
      known_.add(segment);
      triangles_.clear(), boxes_.clear();
      near_(known_, triangles_);
      for (const auto& t : triangles_) boxes_.push_back(box_of(t[0], t[1], t[2]));
      if (triangles_.size() > 32 && reach_ > (segment.hi - segment.lo).maxCoeff())
        reach_ *= 0.5;
      else if (triangles_.size() < 8)
        reach_ = std::min(2 * reach_, most_);
    }
    for (std::size_t k = 0; k < triangles_.size(); ++k)
      if (boxes_[k].meets(segment) &&
          segment_meets_triangle(p, q, triangles_[k][0], triangles_[k][1], triangles_[k][2]))
        return true;
    return false;
  }

 private:
  const NodeSet& nodes_;
  const VisibilityGraph& graph_;
  const ObstacleNear& near_;
  double most_, reach_;
  Box3 known_;  // all triangles that meet this are here
  std::vector<Corners> triangles_;
  std::vector<Box3> boxes_;
};

// Adds the nodes whose shortest paths may have used a cut edge, by old distances: within a support radius of an end,
// less the edge's length. Of several edges at an end the shortest decides.
class Users {
 public:
  Users(const NodeSet& nodes, const VisibilityGraph& graph, IdFlags& update)
      : nodes_(nodes), graph_(graph), update_(update) {}
  /// An end, and at most the length of its shortest edge that is cut.
  void add(std::uint32_t end, std::uint32_t length) {
    if (VisibilityGraph::is_guide(end)) {
      guides_.push_back(std::uint64_t(end) << 32 | length);
    } else {
      update_.add(end);
      add_near(graph_.rows().entries(end), length);
    }
  }
  /// Guides have no rows of neighbours: theirs are looked for.
  void add_guides(RowSearch& search) {
    std::sort(guides_.begin(), guides_.end());
    std::vector<std::uint32_t> ids, lengths;
    for (const auto entry : guides_)
      if (const auto id = static_cast<std::uint32_t>(entry >> 32); ids.empty() || ids.back() != id)
        ids.push_back(id), lengths.push_back(static_cast<std::uint32_t>(entry));
    std::size_t next = 0;
    search.run(nodes_, graph_, ids, {}, [&](std::uint32_t, const RowView& row) { add_near(row, lengths[next++]); });
  }

 private:
  void add_near(const RowView& row, std::uint32_t length) {
    constexpr std::size_t vector = 16;
    if (near_.size() < row.to.size() + vector) near_.resize(2 * row.to.size() + vector), reaches_.resize(near_.size());
    const auto count = neighbors_that_lead_on(row, length, near_.data(), reaches_.data());
    for (std::size_t k = 0; k < count; ++k) update_.add(near_[k]);
  }
  const NodeSet& nodes_;
  const VisibilityGraph& graph_;
  IdFlags& update_;
  std::vector<std::uint64_t> guides_;  // ids, lengths in the lower half
  std::vector<std::uint32_t> near_, reaches_;
};

// Of this thread: its memory is kept from one update to the next.
RowSearch& own_search() {
  thread_local RowSearch search;
  return search;
}

// Rows, kept until all are found.
class RowBatch {
 public:
  void add(std::uint32_t i, const RowView& row) {
    rows_.push_back({i, row.to.size(), row.paths.size()});
    to_.insert(to_.end(), row.to.begin(), row.to.end());
    bits_.insert(bits_.end(), row.bits.begin(), row.bits.end());
    paths_.insert(paths_.end(), row.paths.begin(), row.paths.end());
  }
  void give(const RowSearch::Put& put) const {
    std::size_t entry = 0, path = 0;
    for (const auto& [i, entries, paths] : rows_) {
      put(i, {std::span(to_).subspan(entry, entries), std::span(bits_).subspan(entry, entries),
              std::span(paths_).subspan(path, paths)});
      entry += entries, path += paths;
    }
  }

 private:
  struct Row {
    std::uint32_t i;
    std::size_t entries, paths;
  };
  std::vector<Row> rows_;
  std::vector<std::uint32_t> to_;
  std::vector<std::uint16_t> bits_;
  std::vector<float> paths_;
};

}  // namespace

GraphUpdate update_graph(const NodeSet& nodes, NodeId first_new, std::span<const NodeId> moved,
                         std::span<const Corners> new_faces, const ObstacleNear& obstacle_near, int k,
                         const NodeGrid& grid, VisibilityGraph& graph, std::span<const std::pair<NodeId, NodeId>> joins,
                         const GuideChange& guides, const Progress& progress, std::span<const NodeId> resized) {
  GraphUpdate result;
  RowSearch& search = own_search();
  graph.resize(nodes.size());
  thread_local IdFlags update;
  update.clear();

  // What the faces cut, and all that hangs on the moved nodes.
  report(progress, "cut edges", 0, new_faces.size());
  const Severed severed = find_severed(nodes, graph, grid, first_new, new_faces);
  Users users(nodes, graph, update);
  for (const auto& row : severed.rows)
    if (const auto lost = severed.of(row); std::any_of(
            lost.begin(), lost.end(), [](const auto& entry) { return VisibilityGraph::is_neighbor(entry.bits); }))
      update.add(row.id);
  const auto fetch = [&](const Severed::Row* row) {  // those that come next
    constexpr std::ptrdiff_t ahead = 4;
    const auto left = severed.rows.data() + severed.rows.size() - row;
    if (left > 2 * ahead)
      std::as_const(graph).store(row[2 * ahead].id).prefetch_place(VisibilityGraph::place(row[2 * ahead].id));
    if (left > ahead) std::as_const(graph).store(row[ahead].id).prefetch(VisibilityGraph::place(row[ahead].id));
  };
  for (const auto& row : severed.rows) {
    fetch(&row);
    std::uint32_t shortest = unit_radius;
    for (const auto& entry : severed.of(row))
      shortest =
          std::min(shortest, VisibilityGraph::is_edge(entry.bits) ? VisibilityGraph::bound(entry.bits) : unit_radius);
    if (shortest < unit_radius) users.add(row.id, shortest);
  }
  std::vector<std::pair<NodeId, NodeId>> lost;  // other edges that go, from one end or both
  for (const auto g : guides.retired) {
    const auto row = graph.entries(g);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      lost.push_back({NodeId(g), NodeId(row.to[e])});
      for (const auto end : {g, row.to[e]}) users.add(end, VisibilityGraph::bound(row.bits[e]));
    }
  }
  users.add_guides(search);
  for (const NodeId m : moved) {
    update.add(m.value);
    for (const auto& n : graph.neighbors(nodes, m)) update.add(n.to.value);
    const auto row = graph.entries(m.value);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      if (!VisibilityGraph::is_edge(row.bits[e])) continue;
      if (!VisibilityGraph::is_guide(row.to[e])) update.add(row.to[e]);
      lost.push_back({m, NodeId(row.to[e])});
    }
  }
  // A path along an edge of another length comes through a node that was resized, from one of its neighbours.
  for (const NodeId r : resized) {
    update.add(r.value);
    for (const auto& n : graph.neighbors(nodes, r)) update.add(n.to.value);
  }
  std::vector<std::uint32_t> ends;
  for (const auto& row : severed.rows) {
    fetch(&row);
    ends.clear();
    for (const auto& entry : severed.of(row)) {
      if (!VisibilityGraph::is_edge(entry.bits)) continue;
      ends.push_back(entry.to);
      if (row.id < entry.to && !VisibilityGraph::is_guide(entry.to))
        result.cut_edges.push_back({NodeId(row.id), NodeId(entry.to)});
    }
    graph.drop(row.id, ends);
  }
  for (const auto& [i, j] : lost)
    if (graph.remove(i, j) && !VisibilityGraph::is_guide(i.value) && !VisibilityGraph::is_guide(j.value))
      result.cut_edges.push_back(std::minmax(i, j));
  if (!lost.empty()) std::sort(result.cut_edges.begin(), result.cut_edges.end());

  for (const NodeId r : resized) graph.resize_node(nodes, r);

  // E_new: each new node's k nearest visible nodes.
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
  const auto nearest = nearest_seen(nodes, grid, fresh, k, obstacle_near, progress);
  for (std::size_t f = 0; f < fresh.size(); ++f) {
    const auto i = fresh[f];
    for (const auto j : nearest[f]) join(NodeId(i), NodeId(j));
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
  for (const NodeId r : resized) beginnings.push_back(r.value);  // with its edges shorter, it may be a short cut
  for (const auto& [a, b] : joins) {
    join(a, b);
    beginnings.insert(beginnings.end(), {a.value, b.value});  // an old node that gains an edge is a new beginning, too
  }
  for (std::size_t g = 0; g < guides.added.size(); ++g)
    beginnings.push_back(static_cast<std::uint32_t>(old_guides + g));
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
  report(progress, "neighbourhoods", 0, sources.size());

  // Who saw each other goes on doing so unless a new face came between them. Who did not is asked again: faces that
  // were divided have rounded corners, and a segment that only just touched one may pass now.
  const auto is_fresh = [&](std::uint32_t i) {
    return i >= first_new.value || (!moved.empty() && std::binary_search(fresh.begin(), fresh.end(), i));
  };
  const auto find_rows = [&](std::span<const std::uint32_t> some, const RowSearch::Put& put) {
    PairSight asked(nodes, graph, obstacle_near);
    std::vector<std::uint32_t> lost, unsure;
    auto next_row = std::lower_bound(severed.rows.begin(), severed.rows.end(), some.empty() ? 0 : some.front(),
                                     [](const auto& row, std::uint32_t id) { return row.id < id; });
    auto ahead = some.begin();
    const auto prefetch_next = [&] {
      constexpr std::ptrdiff_t rows = 4;
      if (some.end() - ahead > 2 * rows) graph.rows().prefetch_place(ahead[2 * rows]);
      if (some.end() - ahead > rows) graph.rows().prefetch(ahead[rows]);
      ++ahead;
    };
    const auto mark_hidden = [&](std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits) {
      prefetch_next();
      while (next_row != severed.rows.end() && next_row->id < i) ++next_row;
      lost.clear();
      if (next_row != severed.rows.end() && next_row->id == i)
        for (const auto& entry : severed.of(*next_row))
          if (VisibilityGraph::is_neighbor(entry.bits)) lost.push_back(entry.to);  // others have left the old row
      if (unsure.size() < to.size()) unsure.resize(2 * to.size());
      const auto count =
          unsure_entries(to, bits, is_fresh(i) ? RowView() : graph.rows().entries(i), lost, unsure.data());
      for (std::size_t k = 0; k < count; ++k) {
        const auto e = unsure[k] & ~lost_bit;
        if (((unsure[k] & lost_bit) && !is_fresh(to[e])) || asked.blocked(i, to[e]))
          bits[e] |= VisibilityGraph::path_bit;
      }
      if (moved.empty()) return;
      for (std::size_t e = 0; e < to.size(); ++e)  // what is seen of those is not what it was
        if (!VisibilityGraph::is_edge(bits[e]) && to[e] < first_new.value && is_fresh(to[e]) && asked.blocked(i, to[e]))
          bits[e] |= VisibilityGraph::path_bit;
    };
    own_search().run(nodes, graph, some, mark_hidden, put);
  };
  const auto set = [&](std::uint32_t i, const RowView& row) { graph.set_neighbors(NodeId(i), row); };
  // Searches go together where they see the same: on one side of the cut.
  std::vector<std::uint32_t> sides[2];
  auto next_row = severed.rows.begin();
  for (const auto i : sources) {
    while (next_row != severed.rows.end() && next_row->id < i) ++next_row;
    sides[next_row != severed.rows.end() && next_row->id == i && next_row->above].push_back(i);
  }
  constexpr std::size_t grain = 1024, few = 64;
  if (threads() == 1 || sources.size() <= few) {
    for (const auto& side : sides) find_rows(side, set);
  } else {
    // The graph stays as it is until all are found.
    std::vector<std::span<const std::uint32_t>> parts;
    for (const auto& side : sides)
      for (std::size_t first = 0; first < side.size(); first += grain)
        parts.push_back(std::span(side).subspan(first, std::min(grain, side.size() - first)));
    std::vector<RowBatch> batches(parts.size());
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        find_rows(parts[b], [&](std::uint32_t i, const RowView& row) { batches[b].add(i, row); });
    });
    for (const RowBatch& batch : batches) batch.give(set);
  }
  for (const auto i : sources) result.updated_nodes.push_back(NodeId(i));
  return result;
}

}  // namespace geo
