// The visibility graph G (§ 6.1): which nodes see each other, and who is near whom along it (§ 6.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "graph/guide_set.h"
#include "graph/lengths.h"
#include "graph/row_store.h"
#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

struct Neighbor {
  NodeId to;
  std::uint32_t warped =
      0;  ///< graph distance in 2⁻²⁴ support radii, < unit_radius, rounded down to 2⁻¹⁴ of a radius (§ 6.4)
  float distance = 0;  ///< what weights use, model units: Euclidean where the pair sees each other, else the path's
};

/// An undirected graph over nodes, and the neighbours of each: one row a node for both, ascending by node. Edges are
/// kept however long they are (connectivity does not depend on radii); one as long as the support joins no neighbours.
/// Lengths of edges and distances of pairs that see each other are not stored: they are functions of the nodes.
/// Neighbours are symmetric: j is one of i's exactly when i is one of j's. They are there once build_neighborhoods()
/// was called, and follow changes of the graph through update_graph() only. Besides nodes there may be guides (§ 8):
/// paths lead through them, but they are nobody's neighbours. Their ids begin at first_guide, so they come last in
/// rows, as ends of edges; what is said of nodes below leaves them out.
class VisibilityGraph {
 public:
  std::size_t node_count() const { return rows_.size(); }
  std::size_t edge_count() const { return edges_; }
  void resize(std::size_t nodes) { rows_.resize(nodes); }

  class Edges;
  class Neighbors;
  /// The nodes at the other ends of i's edges, ascending: a range of NodeId.
  Edges edges(NodeId i) const;
  /// i's neighbours, ascending, without i itself: a range of Neighbor. `nodes` must be the graph's and outlive the
  /// range.
  Neighbors neighbors(const NodeSet& nodes, NodeId i) const;
  std::size_t neighbor_count(NodeId i) const;

  bool has(NodeId i, NodeId j) const;
  /// Adds (between these nodes, of this set) or removes the edge ij; both directions. False when it was (was not)
  /// there. Neighbours stay what they are.
  bool add(const NodeSet& nodes, NodeId i, NodeId j);
  bool remove(NodeId i, NodeId j);
  /// To be told when a node's radius has changed. Its edges stay; where they are shorter now, rows no longer bound them
  /// by more. Neighbours stay what they are: see update_graph().
  void resize_node(const NodeSet& nodes, NodeId i);
  /// Removes edges of a node or guide that it has, to some others (ascending), at its end only: that they are removed
  /// at the other ends, too, is up to the caller.
  void drop(std::uint32_t id, std::span<const std::uint32_t> others);

  static constexpr std::uint32_t first_guide = 1u << 31;
  static constexpr bool is_guide(std::uint32_t id) { return id >= first_guide; }
  const GuideSet& guides() const { return guides_; }
  /// A new guide, without edges; returns its id. See add_guides() and update_graph().
  std::uint32_t add_guide(const Guide& guide);
  /// A guide without edges is not to have any: see update_graph().
  void retire_guide(std::uint32_t id) { guides_.retire(place(id)); }
  /// Edges between guides and others, given from both ends, ascending; each lies behind all that its row has.
  void append_guide_edges(const NodeSet& nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);
  /// Of a node or guide.
  const Vec3& position(const NodeSet& nodes, std::uint32_t id) const {
    return is_guide(id) ? guides_.position(place(id)) : nodes.position[id];
  }
  double radius(const NodeSet& nodes, std::uint32_t id) const {
    return is_guide(id) ? guides_.radius(place(id)) : nodes.radius[id];
  }
  std::uint32_t warped(const NodeSet& nodes, std::uint32_t i, std::uint32_t j) const {
    return warped_length(position(nodes, i), position(nodes, j), radius(nodes, i), radius(nodes, j));
  }
  /// The row of a node or guide, without floats. A guide's has its edges only.
  RowView entries(std::uint32_t id) const { return store(id).entries(place(id)); }
  const RowStore& store(std::uint32_t id) const { return is_guide(id) ? guide_rows_ : rows_; }
  /// Of an id in its store.
  static constexpr std::uint32_t place(std::uint32_t id) { return id & ~first_guide; }

  /// The unit of plain lengths, set once: plain_unit_for() the nodes it is built for.
  double plain_unit() const { return plain_unit_; }
  void set_plain_unit(double unit) { plain_unit_ = unit; }
  /// No edge is longer than this and no two neighbours are farther apart, in model units.
  double reach() const { return reach_; }
  /// No edge that joins neighbours is longer than this, and no two neighbours are farther apart.
  double support() const { return support_; }
  /// Component of each node, numbered by lowest node; returns their count.
  std::uint32_t components(std::vector<std::uint32_t>& of) const;
  /// Bytes of all rows and guides.
  std::size_t bytes() const { return rows_.bytes() + guide_rows_.bytes() + guides_.bytes(); }

  /// Rows as they are stored, for files and searches: entries as the functions below read them.
  const RowStore& rows() const { return rows_; }
  static constexpr std::uint16_t edge_bit = 1u << 15, path_bit = 1u << 14, bound_bits = path_bit - 1;
  static constexpr bool is_edge(std::uint16_t bits) { return bits & edge_bit; }
  static constexpr bool is_neighbor(std::uint16_t bits) {
    return (bits & (edge_bit | path_bit)) != (edge_bit | path_bit);
  }
  /// At most the warped distance of a pair; of an edge that joins no neighbours (yet), at most its length.
  static constexpr std::uint32_t bound(std::uint16_t bits) { return std::uint32_t(bits & bound_bits) << 10; }
  static constexpr std::uint16_t bits_of_bound(std::uint32_t warped) {
    return static_cast<std::uint16_t>(warped >= unit_radius ? bound_bits : warped >> 10);
  }

  /// Puts a row in place of i's: its edges must be i's.
  void set_neighbors(NodeId i, const RowView& row) { rows_.set(i.index(), row); }
  /// All rows at once: their edges must be the graph's.
  void replace_rows(RowStore rows) { rows_.swap(rows); }
  /// See RowStore::give_block(): until replace_rows() the rows of nodes in it are lost.
  void give_block(std::uint32_t block, RowStore& to) { rows_.give_block(block, to); }
  /// From all rows as flat arrays, in node order, row i with count[i] entries. Throws InputError, which names the first
  /// entry that cannot be: out of order or range, or not the same from both ends. Edges between nodes and guides are in
  /// the nodes' rows, those between guides in `guide_edges`.
  static VisibilityGraph from_rows(const NodeSet& nodes, double plain_unit, std::span<const std::uint32_t> count,
                                   std::span<const std::uint32_t> to, std::span<const std::uint16_t> bits,
                                   std::span<const float> paths, std::span<const Guide> guides = {},
                                   std::span<const std::array<std::uint32_t, 2>> guide_edges = {});
  /// Pairs of guides with edges, numbered from 0, the greater first, ascending.
  std::vector<std::array<std::uint32_t, 2>> guide_edges() const;

  /// The same edges and neighbours, to the last bit.
  friend bool operator==(const VisibilityGraph& a, const VisibilityGraph& b);

 private:
  friend VisibilityGraph build_visibility_graph(const NodeSet&, const TriangleBvh&, int, const Progress&);

  RowStore& store(std::uint32_t id) { return is_guide(id) ? guide_rows_ : rows_; }

  RowStore rows_, guide_rows_;
  GuideSet guides_;
  std::size_t edges_ = 0;
  double plain_unit_ = 1, reach_ = 0, support_ = 0;
};

/// EMST ∪ k nearest, minus every edge that touches a triangle of `obstacles` (closed semantics, exact). Without
/// neighbours yet.
VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k,
                                       const Progress& progress = {});

/// A range over the entries of a row that are edges.
class VisibilityGraph::Edges {
 public:
  class Iterator {
   public:
    Iterator(const RowView& row, std::size_t at) : row_(row), at_(at) { skip(); }
    NodeId operator*() const { return NodeId(row_.to[at_]); }
    Iterator& operator++() {
      ++at_, skip();
      return *this;
    }
    bool operator!=(const Iterator& o) const { return at_ != o.at_; }

   private:
    void skip() {
      while (at_ < row_.to.size() && !is_edge(row_.bits[at_])) ++at_;
    }
    RowView row_;
    std::size_t at_;
  };
  explicit Edges(const RowView& row) : row_(row) {
    while (!row_.to.empty() && is_guide(row_.to.back())) row_.to = row_.to.first(row_.to.size() - 1);
  }
  Iterator begin() const { return {row_, 0}; }
  Iterator end() const { return {row_, row_.to.size()}; }

 private:
  RowView row_;
};

/// A range over the entries of a row that are neighbours.
class VisibilityGraph::Neighbors {
 public:
  class Iterator {
   public:
    Iterator(const RowView& row, const NodeSet& nodes, std::size_t i, std::size_t at)
        : row_(row), nodes_(&nodes), i_(i), at_(at) {
      skip();
    }
    Neighbor operator*() const {
      const auto to = row_.to[at_];
      const float distance =
          RowStore::has_path(row_.bits[at_])
              ? row_.paths[path_]
              : static_cast<float>(std::sqrt(squared_distance(nodes_->position[i_], nodes_->position[to])));
      return {NodeId(to), bound(row_.bits[at_]), distance};
    }
    Iterator& operator++() {
      path_ += RowStore::has_path(row_.bits[at_]);
      ++at_, skip();
      return *this;
    }
    bool operator!=(const Iterator& o) const { return at_ != o.at_; }

   private:
    void skip() {
      while (at_ < row_.to.size() && !is_neighbor(row_.bits[at_])) ++at_;
    }
    RowView row_;
    const NodeSet* nodes_;
    std::size_t i_, at_, path_ = 0;
  };
  Neighbors(const RowView& row, const NodeSet& nodes, NodeId i) : row_(row), nodes_(&nodes), i_(i.index()) {}
  Iterator begin() const { return {row_, *nodes_, i_, 0}; }
  Iterator end() const { return {row_, *nodes_, i_, row_.to.size()}; }

 private:
  RowView row_;
  const NodeSet* nodes_;
  std::size_t i_;
};

inline VisibilityGraph::Edges VisibilityGraph::edges(NodeId i) const { return Edges(rows_.entries(i.index())); }
inline VisibilityGraph::Neighbors VisibilityGraph::neighbors(const NodeSet& nodes, NodeId i) const {
  return {rows_.row(i.index()), nodes, i};
}

// ---- Neighbours of nodes (§ 6.2): everything within the support radius along the visibility graph.

enum class NeighborMethod { automatic, dijkstra, mfw };

/// All neighbours of all nodes from scratch, into the graph. `mfw` is the paper's modified Floyd-Warshall, `dijkstra` a
/// plain bounded one, `automatic` the fastest we have; all give the same rows, bit for bit, for any number of threads
/// and any vector instructions. Memory of the edges' rows is used again while it runs: if it throws, the graph is lost.
void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, const TriangleBvh& obstacles,
                         NeighborMethod method = NeighborMethod::automatic, const Progress& progress = {});

}  // namespace geo
