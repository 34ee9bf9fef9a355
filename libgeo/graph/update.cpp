// The update of the graph after a crack step (§ 6.3, 6.4).
//
// Symbols of the paper:
//   E_cut     edges that a new face touches
//   P_new     new nodes
//   E_new     edges that new nodes get: to their k nearest visible nodes
//   P_update  nodes whose neighbours may have changed; their rows are recomputed
// One departure: rows are recomputed on the whole graph. A detour between two nodes of P_update may
// leave P_update: its middle can be far from the cut while both ends are near. The paper's subgraph
// would miss it.
#include "graph/update.h"

#include <algorithm>
#include <utility>

#include "geometry/predicates.h"
#include "graph/batched_search.h"
#include "graph/cut_pairs.h"
#include "graph/graph_storage.h"
#include "graph/guide_edges.h"
#include "graph/id_set.h"
#include "graph/nearest_visible.h"
#include "graph/neighborhood_search.h"
#include "graph/visibility_reuse.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;

// Visibility of pairs (i, j). Most pairs share i: triangles around i are read once, within a
// distance that adapts to the number of triangles.
class PairVisibility {
 public:
  PairVisibility(const NodeSet& nodes, const GraphStorage& graph, const TrianglesNear& near)
      : nodes_(nodes), graph_(graph), near_(near), largest_reach_(graph.longest_edge()), reach_(largest_reach_) {}
  bool blocked(std::uint32_t i, std::uint32_t j) {
    const Vec3 &p = graph_.position(nodes_, std::min(i, j)), &q = graph_.position(nodes_, std::max(i, j));
    Box3 segment{p, p};
    segment.add(q);
    if (covered_.empty() || (segment.lo.array() < covered_.lo.array()).any() ||
        (segment.hi.array() > covered_.hi.array()).any())
      read_around(i < j ? p : q, segment);
    for (std::size_t k = 0; k < triangles_.size(); ++k)
      if (boxes_[k].meets(segment) &&
          segment_meets_triangle(p, q, triangles_[k][0], triangles_[k][1], triangles_[k][2]))
        return true;
    return false;
  }

 private:
  void read_around(const Vec3& center, const Box3& segment) {
    covered_ = {center - Vec3::Constant(reach_), center + Vec3::Constant(reach_)};
    covered_.add(segment);
    triangles_.clear();
    boxes_.clear();
    near_(covered_, triangles_);
    for (const auto& t : triangles_) boxes_.push_back(box_of(t[0], t[1], t[2]));
    // Each read serves many pairs if the box is large, each test is cheap if it is small: 8 to 32
    // triangles are kept. The result does not depend on them.
    if (triangles_.size() > 32 && reach_ > (segment.hi - segment.lo).maxCoeff())
      reach_ *= 0.5;
    else if (triangles_.size() < 8)
      reach_ = std::min(2 * reach_, largest_reach_);
  }

  const NodeSet& nodes_;
  const GraphStorage& graph_;
  const TrianglesNear& near_;
  double largest_reach_, reach_;
  Box3 covered_;  // all triangles that meet this box are in triangles_
  std::vector<Corners> triangles_;
  std::vector<Box3> boxes_;
};

// Finds the nodes whose shortest paths may use a removed edge. A path from node p that uses edge e
// at its end q has d(p, q) + length(e) < support radius. Distances d are those before the step.
class PathUsers {
 public:
  PathUsers(const NodeSet& nodes, const GraphStorage& graph, IdSet& users)
      : nodes_(nodes), graph_(graph), users_(users) {}
  /// Adds the users of edges at `end` that are no shorter than `length`.
  void add(std::uint32_t end, std::uint32_t length) {
    if (GraphStorage::is_guide(end)) {
      guides_.push_back(std::uint64_t(end) << 32 | length);
    } else {
      users_.add(end);
      add_near(graph_.rows().entries(end), length);
    }
  }
  /// Adds the users at guides. Guides have no neighbours in their rows, so a search finds them.
  void add_at_guides(NeighborhoodSearch& search) {
    std::sort(guides_.begin(), guides_.end());
    std::vector<std::uint32_t> ids, lengths;
    for (const auto entry : guides_)
      if (const auto id = static_cast<std::uint32_t>(entry >> 32); ids.empty() || ids.back() != id) {
        ids.push_back(id);
        lengths.push_back(static_cast<std::uint32_t>(entry));
      }
    std::size_t next = 0;
    search.run(nodes_, graph_, ids, {},
               [&](std::uint32_t, const AdjacencyRow& row) { add_near(row, lengths[next++]); });
  }

 private:
  void add_near(const AdjacencyRow& row, std::uint32_t length) {
    constexpr std::size_t vector = 16;
    if (near_.size() < row.to.size() + vector) {
      near_.resize(2 * row.to.size() + vector);
      distances_.resize(near_.size());
    }
    const auto count = neighbors_within_support(row, length, near_.data(), distances_.data());
    for (std::size_t k = 0; k < count; ++k) users_.add(near_[k]);
  }
  const NodeSet& nodes_;
  const GraphStorage& graph_;
  IdSet& users_;
  std::vector<std::uint64_t> guides_;  // ids; lengths in the lower half
  std::vector<std::uint32_t> near_, distances_;
};

// One search a thread: its memory is kept from one update to the next.
NeighborhoodSearch& thread_search() {
  thread_local NeighborhoodSearch search;
  return search;
}

// Rows that wait to be stored until all are found.
class RowBatch {
 public:
  void add(std::uint32_t i, const AdjacencyRow& row) {
    rows_.push_back({i, row.to.size(), row.paths.size()});
    to_.insert(to_.end(), row.to.begin(), row.to.end());
    bits_.insert(bits_.end(), row.bits.begin(), row.bits.end());
    paths_.insert(paths_.end(), row.paths.begin(), row.paths.end());
  }
  void store(const NeighborhoodSearch::Store& store_row) const {
    std::size_t entry = 0, path = 0;
    for (const auto& [i, entries, paths] : rows_) {
      store_row(i, {std::span(to_).subspan(entry, entries), std::span(bits_).subspan(entry, entries),
                    std::span(paths_).subspan(path, paths)});
      entry += entries;
      path += paths;
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

// The steps of an update, in order. `result` grows along the way.
class GraphUpdater {
 public:
  GraphUpdater(const GraphChange& change, GraphStorage& graph, const Progress& progress, IdSet& update)
      : in_(change), nodes_(change.nodes), graph_(graph), progress_(progress), update_(update) {
    update_.clear();
    graph_.resize(nodes_.size());
    for (const NodeId m : in_.moved) fresh_.push_back(m.value);
    for (std::uint32_t i = in_.first_new.value; i < nodes_.size(); ++i) fresh_.push_back(i);
  }

  void find_cut_edges();
  void remove_edges();
  void change_guides();
  void add_edges();
  void add_users_of_new_edges();
  void recompute_rows();

  GraphUpdate result;

 private:
  void prefetch_rows_behind(const CutPairs::Row& row) const;
  void detach_retired_guides(PathUsers& users);
  void detach_moved_nodes();
  void mark_around_resized_nodes();
  void join(NodeId i, NodeId j) {
    if (graph_.add(nodes_, i.value, j.value)) result.added_edges.push_back(std::minmax(i, j));
  }
  void join_new_nodes(PairVisibility& visibility);
  void join_new_guides(PairVisibility& visibility);
  bool is_fresh(std::uint32_t i) const {
    return i >= in_.first_new.value || (!in_.moved.empty() && std::binary_search(fresh_.begin(), fresh_.end(), i));
  }
  void find_rows(std::span<const std::uint32_t> sources, const NeighborhoodSearch::Store& store) const;

  const GraphChange& in_;
  const NodeSet& nodes_;
  GraphStorage& graph_;
  const Progress& progress_;
  IdSet& update_;                                   // P_update
  CutPairs cut_;                                    // E_cut, and neighbours that new faces come between
  std::vector<std::pair<NodeId, NodeId>> removed_;  // other edges that go, from one end or both
  std::vector<std::uint32_t> fresh_;                // P_new and moved nodes; ascending once edges are added
  std::uint32_t first_new_guide_ = 0;
};

// E_cut, and the nodes whose rows depend on an edge or a line of sight that goes.
void GraphUpdater::find_cut_edges() {
  report(progress_, "cut edges", 0, in_.new_faces.size());
  cut_ = find_cut_pairs(nodes_, graph_, in_.grid, in_.first_new, in_.new_faces);
  PathUsers users(nodes_, graph_, update_);
  for (const auto& row : cut_.rows)
    if (const auto lost = cut_.of(row);
        std::any_of(lost.begin(), lost.end(), [](const auto& entry) { return AdjacencyRow::is_neighbor(entry.bits); }))
      update_.add(row.id);
  for (const auto& row : cut_.rows) {
    prefetch_rows_behind(row);
    std::uint32_t shortest = unit_radius;
    for (const auto& entry : cut_.of(row))
      shortest = std::min(shortest, AdjacencyRow::is_edge(entry.bits) ? AdjacencyRow::bound(entry.bits) : unit_radius);
    if (shortest < unit_radius) users.add(row.id, shortest);
  }
  detach_retired_guides(users);
  users.add_at_guides(thread_search());
  detach_moved_nodes();
  mark_around_resized_nodes();
}

void GraphUpdater::prefetch_rows_behind(const CutPairs::Row& row) const {
  const auto at = static_cast<std::size_t>(&row - cut_.rows.data());
  graph_.prefetch_after(at, cut_.rows.size(), [&](std::size_t i) { return cut_.rows[i].id; });
}

void GraphUpdater::detach_retired_guides(PathUsers& users) {
  for (const auto g : in_.guides.retired) {
    const auto row = graph_.entries(g);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      removed_.push_back({NodeId(g), NodeId(row.to[e])});
      for (const auto end : {g, row.to[e]}) users.add(end, AdjacencyRow::bound(row.bits[e]));
    }
  }
}

void GraphUpdater::detach_moved_nodes() {
  for (const NodeId m : in_.moved) {
    update_.add(m.value);
    for (const auto& n : graph_.neighbors(nodes_, m)) update_.add(n.to.value);
    const auto row = graph_.entries(m.value);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      if (!AdjacencyRow::is_edge(row.bits[e])) continue;
      if (!GraphStorage::is_guide(row.to[e])) update_.add(row.to[e]);
      removed_.push_back({m, NodeId(row.to[e])});
    }
  }
}

// A path along an edge whose length changes passes a resized node, from one of its neighbours.
void GraphUpdater::mark_around_resized_nodes() {
  for (const NodeId r : in_.resized) {
    update_.add(r.value);
    for (const auto& n : graph_.neighbors(nodes_, r)) update_.add(n.to.value);
  }
}

void GraphUpdater::remove_edges() {
  std::vector<std::uint32_t> ends;
  for (const auto& row : cut_.rows) {
    prefetch_rows_behind(row);
    ends.clear();
    for (const auto& entry : cut_.of(row)) {
      if (!AdjacencyRow::is_edge(entry.bits)) continue;
      ends.push_back(entry.to);
      if (row.id < entry.to && !GraphStorage::is_guide(entry.to))
        result.cut_edges.push_back({NodeId(row.id), NodeId(entry.to)});
    }
    graph_.drop(row.id, ends);
  }
  for (const auto& [i, j] : removed_)
    if (graph_.remove(i.value, j.value) && !GraphStorage::is_guide(i.value) && !GraphStorage::is_guide(j.value))
      result.cut_edges.push_back(std::minmax(i, j));
  if (!removed_.empty()) std::sort(result.cut_edges.begin(), result.cut_edges.end());
  for (const NodeId r : in_.resized) graph_.lower_bounds(nodes_, r);
}

void GraphUpdater::change_guides() {
  first_new_guide_ = GraphStorage::guide_id(graph_.guides().size());
  for (const auto g : in_.guides.retired) graph_.retire_guide(g);
  for (const Guide& guide : in_.guides.added) graph_.add_guide(guide);
}

// E_new, the edges of guides, and the joins.
void GraphUpdater::add_edges() {
  PairVisibility visibility(nodes_, graph_, in_.triangles_near);
  join_new_nodes(visibility);
  join_new_guides(visibility);
  std::sort(fresh_.begin(), fresh_.end());
  for (const auto& [a, b] : in_.joins) join(a, b);
  std::sort(result.added_edges.begin(), result.added_edges.end());
}

void GraphUpdater::join_new_nodes(PairVisibility& visibility) {
  const auto nearest = nearest_visible(nodes_, in_.grid, fresh_, in_.k, in_.triangles_near, progress_);
  std::vector<std::uint32_t> guides;
  for (std::size_t f = 0; f < fresh_.size(); ++f) {
    const auto i = fresh_[f];
    for (const auto j : nearest[f]) join(NodeId(i), NodeId(j));
    guides.clear();
    guides_near(nodes_, graph_, i, guides);
    for (const auto g : guides)
      if (g < first_new_guide_ && !visibility.blocked(i, g)) graph_.add(nodes_, i, g);
  }
}

void GraphUpdater::join_new_guides(PairVisibility& visibility) {
  std::vector<std::vector<std::uint32_t>> visible(in_.guides.added.size());
  for (std::size_t g = 0; g < visible.size(); ++g) {
    const auto id = static_cast<std::uint32_t>(first_new_guide_ + g);
    ids_near_guide(nodes_, in_.grid, graph_, id, visible[g]);
    std::erase_if(visible[g], [&](std::uint32_t other) { return visibility.blocked(id, other); });
  }
  add_guide_edges(nodes_, visible, graph_);
}

// A new or shortened edge may give a shorter path to nodes within a support radius of one of its
// ends. They belong to P_update, too.
void GraphUpdater::add_users_of_new_edges() {
  std::vector<std::uint32_t> starts = fresh_;
  for (const NodeId r : in_.resized) starts.push_back(r.value);
  for (const auto& [a, b] : in_.joins) starts.insert(starts.end(), {a.value, b.value});
  for (std::size_t g = 0; g < in_.guides.added.size(); ++g)
    starts.push_back(static_cast<std::uint32_t>(first_new_guide_ + g));
  std::sort(starts.begin(), starts.end());
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  const auto add = [&](std::uint32_t id) {
    if (!GraphStorage::is_guide(id)) update_.add(id);
  };
  thread_search().run(nodes_, graph_, starts, {}, [&](std::uint32_t i, const AdjacencyRow& row) {
    add(i);
    for (const auto j : row.to) add(j);
  });
}

// Finds the rows of some nodes of P_update (ascending). A pair that saw each other still does,
// unless a new face came between. A pair that did not is tested again: divided faces have rounded
// corners, and a segment that barely touched one may pass now.
void GraphUpdater::find_rows(std::span<const std::uint32_t> sources, const NeighborhoodSearch::Store& store) const {
  const GraphStorage& graph = graph_;
  PairVisibility visibility(nodes_, graph, in_.triangles_near);
  std::vector<std::uint32_t> hidden, retest;  // hidden: neighbours that a new face hides
  auto cut_row = std::lower_bound(cut_.rows.begin(), cut_.rows.end(), sources.empty() ? 0 : sources.front(),
                                  [](const auto& row, std::uint32_t id) { return row.id < id; });
  std::size_t at = 0;  // of the source at hand
  const auto mark_hidden = [&](std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits) {
    graph.prefetch_after(at++, sources.size(), [&](std::size_t k) { return sources[k]; });
    while (cut_row != cut_.rows.end() && cut_row->id < i) ++cut_row;
    hidden.clear();
    if (cut_row != cut_.rows.end() && cut_row->id == i)
      for (const auto& entry : cut_.of(*cut_row))
        if (AdjacencyRow::is_neighbor(entry.bits)) hidden.push_back(entry.to);  // others have left the old row
    if (retest.size() < to.size()) retest.resize(2 * to.size());
    const auto count =
        entries_to_retest(to, bits, is_fresh(i) ? AdjacencyRow() : graph.rows().entries(i), hidden, retest.data());
    for (std::size_t k = 0; k < count; ++k) {
      const auto e = retest[k] & ~hidden_bit;
      if (((retest[k] & hidden_bit) && !is_fresh(to[e])) || visibility.blocked(i, to[e]))
        bits[e] |= AdjacencyRow::path_bit;
    }
    if (in_.moved.empty()) return;
    // Lines of sight to moved nodes have changed.
    for (std::size_t e = 0; e < to.size(); ++e)
      if (!AdjacencyRow::is_edge(bits[e]) && to[e] < in_.first_new.value && is_fresh(to[e]) &&
          visibility.blocked(i, to[e]))
        bits[e] |= AdjacencyRow::path_bit;
  };
  thread_search().run(nodes_, graph, sources, mark_hidden, store);
}

void GraphUpdater::recompute_rows() {
  std::vector<std::uint32_t> sources = update_.ids();
  std::sort(sources.begin(), sources.end());
  report(progress_, "neighbourhoods", 0, sources.size());
  const auto store = [&](std::uint32_t i, const AdjacencyRow& row) { graph_.set_neighbors(NodeId(i), row); };
  // Nodes on one side of the cut share most of their paths, so they are searched from together.
  std::vector<std::uint32_t> sides[2];
  auto cut_row = cut_.rows.begin();
  for (const auto i : sources) {
    while (cut_row != cut_.rows.end() && cut_row->id < i) ++cut_row;
    sides[cut_row != cut_.rows.end() && cut_row->id == i && cut_row->above].push_back(i);
  }
  // `few`: below this, threads cost more than they save. `grain`: sources of a thread's task.
  constexpr std::size_t grain = 1024, few = 64;
  if (threads() == 1 || sources.size() <= few) {
    for (const auto& side : sides) find_rows(side, store);
  } else {
    // The graph does not change until all rows are found.
    std::vector<std::span<const std::uint32_t>> chunks;
    for (const auto& side : sides)
      for (std::size_t first = 0; first < side.size(); first += grain)
        chunks.push_back(std::span(side).subspan(first, std::min(grain, side.size() - first)));
    std::vector<RowBatch> batches(chunks.size());
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        find_rows(chunks[b], [&](std::uint32_t i, const AdjacencyRow& row) { batches[b].add(i, row); });
    });
    for (const RowBatch& batch : batches) batch.store(store);
  }
  for (const auto i : sources) result.updated_nodes.push_back(NodeId(i));
}

}  // namespace

GraphUpdate update_graph(const GraphChange& change, VisibilityGraph& graph, const Progress& progress) {
  thread_local IdSet update;
  GraphUpdater updater(change, GraphStorage::of(graph), progress, update);
  updater.find_cut_edges();          // E_cut, and P_update from it
  updater.remove_edges();            // E \ E_cut
  updater.change_guides();           // § 8
  updater.add_edges();               // E ∪ E_new
  updater.add_users_of_new_edges();  // P_update from E_new
  updater.recompute_rows();          // neighbours of P_update
  return std::move(updater.result);
}

}  // namespace geo
