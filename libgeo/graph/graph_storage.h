// The storage of a VisibilityGraph: adjacency rows of nodes and guides, and the guides themselves.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/adjacency_store.h"
#include "graph/guide_set.h"
#include "graph/lengths.h"
#include "kerf/graph.h"

namespace geo {

/// The representation behind VisibilityGraph, with inline access for hot loops. Nodes and guides
/// share one space of ids; those of guides begin at VisibilityGraph::first_guide. A guide's row
/// holds its edges only. Lengths of edges and distances of pairs that see each other are not
/// stored: they are functions of the nodes.
class GraphStorage {
 public:
  /// The storage of a graph.
  static GraphStorage& of(VisibilityGraph& graph) { return *graph.storage_; }
  /// As above, read-only.
  static const GraphStorage& of(const VisibilityGraph& graph) { return *graph.storage_; }

  /// Is this the id of a guide?
  static constexpr bool is_guide(std::uint32_t id) { return VisibilityGraph::is_guide(id); }
  /// The index of an id in its store: nodes and guides each count from 0.
  static constexpr std::uint32_t index_of(std::uint32_t id) { return id & ~VisibilityGraph::first_guide; }
  /// The id of the g-th guide.
  static constexpr std::uint32_t guide_id(std::uint32_t g) { return VisibilityGraph::first_guide + g; }

  /// Number of nodes.
  std::size_t node_count() const { return rows_.size(); }
  /// Number of edges between nodes.
  std::size_t edge_count() const { return edges_; }
  /// Sets the number of nodes; new nodes have no edges.
  void resize(std::size_t nodes) { rows_.resize(nodes); }

  /// See VisibilityGraph::edges().
  VisibilityGraph::Edges edges(NodeId i) const { return VisibilityGraph::Edges(rows_.entries(i.index())); }
  /// See VisibilityGraph::neighbors().
  VisibilityGraph::Neighbors neighbors(const NodeSet& nodes, NodeId i) const {
    return {rows_.row(i.index()), nodes, i};
  }
  /// Does the edge between two nodes or guides exist?
  bool has(std::uint32_t i, std::uint32_t j) const;

  /// Adds the edge between two nodes or guides, in both rows. False when it exists. Neighbours do
  /// not change.
  bool add(const NodeSet& nodes, std::uint32_t i, std::uint32_t j);
  /// Removes the edge from both rows. False when it does not exist. Neighbours do not change.
  bool remove(std::uint32_t i, std::uint32_t j);
  /// Removes edges to `others` (ascending), which exist, from the row of `id` only. The caller
  /// removes them from the rows of the other ends.
  void drop(std::uint32_t id, std::span<const std::uint32_t> others);
  /// Lowers the bounds of a node's edges after its radius has changed. Edges and neighbours do not
  /// change.
  void lower_bounds(const NodeSet& nodes, NodeId i);

  /// The guides.
  const GuideSet& guides() const { return guides_; }
  /// Adds a guide without edges; returns its id.
  std::uint32_t add_guide(const Guide& guide);
  /// Marks a guide as retired. Precondition: it has no edges.
  void retire_guide(std::uint32_t id) { guides_.retire(index_of(id)); }
  /// Appends edges to rows of guides and others: pairs (row, other end), from both ends, ascending.
  /// Precondition: each other end lies behind all that its row holds.
  void append_guide_edges(const NodeSet& nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);
  /// Pairs of guides joined by an edge, numbered from 0, the greater first, ascending.
  std::vector<std::array<std::uint32_t, 2>> guide_edges() const;

  /// Position of a node or guide.
  const Vec3& position(const NodeSet& nodes, std::uint32_t id) const {
    return is_guide(id) ? guides_.position(index_of(id)) : nodes.position[id];
  }
  /// Support radius of a node or guide.
  double radius(const NodeSet& nodes, std::uint32_t id) const {
    return is_guide(id) ? guides_.radius(index_of(id)) : nodes.radius[id];
  }
  /// Warped length of the edge between two nodes or guides.
  std::uint32_t warped(const NodeSet& nodes, std::uint32_t i, std::uint32_t j) const {
    return warped_length(position(nodes, i), position(nodes, j), radius(nodes, i), radius(nodes, j));
  }

  /// The row of a node or guide, without lengths of paths.
  AdjacencyRow entries(std::uint32_t id) const { return store(id).entries(index_of(id)); }
  /// The store that holds the row of an id.
  const AdjacencyStore& store(std::uint32_t id) const { return is_guide(id) ? guide_rows_ : rows_; }
  /// For loops over rows: prefetches the row of an id that comes later, so that memory answers
  /// while the rows between are handled. `id_at(i)`: the i-th of `count` ids; `at`: the one at
  /// hand.
  template <class IdAt>
  void prefetch_after(std::size_t at, std::size_t count, const IdAt& id_at) const {
    // Rows ahead. The location of a row is prefetched twice as early, since its address depends on
    // it. Fewer: memory answers too late; more: rows leave the cache before their turn.
    constexpr std::size_t ahead = 4;
    if (count - at > 2 * ahead) {
      const auto id = id_at(at + 2 * ahead);
      store(id).prefetch_location(index_of(id));
    }
    if (count - at > ahead) {
      const auto id = id_at(at + ahead);
      store(id).prefetch(index_of(id));
    }
  }
  /// The rows of nodes.
  const AdjacencyStore& rows() const { return rows_; }
  /// Replaces the row of a node. Precondition: `row` has the same edges.
  void set_neighbors(NodeId i, const AdjacencyRow& row) { rows_.set(i.index(), row); }
  /// Replaces all rows of nodes. Precondition: `rows` have the same edges.
  void replace_rows(AdjacencyStore rows) { rows_.swap(rows); }
  /// See AdjacencyStore::give_block(). Rows of nodes in the block are lost until replace_rows().
  void give_block(std::uint32_t block, AdjacencyStore& to) { rows_.give_block(block, to); }

  /// The unit of plain lengths: plain_unit_for() the nodes that the graph was built for.
  double plain_unit() const { return plain_unit_; }
  /// Sets the unit of plain lengths, once.
  void set_plain_unit(double unit) { plain_unit_ = unit; }
  /// Upper bound of the lengths of all edges and of the Euclidean distances of all neighbours.
  /// Model units.
  double longest_edge() const { return longest_edge_; }
  /// Largest support radius of nodes and guides so far: an upper bound of the Euclidean distances
  /// of all neighbours. Model units.
  double largest_support() const { return largest_support_; }

  /// See VisibilityGraph::components().
  std::uint32_t components(std::vector<std::uint32_t>& component) const;
  /// Bytes of all rows and guides.
  std::size_t bytes() const { return rows_.bytes() + guide_rows_.bytes() + guides_.bytes(); }

  /// A graph without neighbours from edges between nodes, i < j, each once, in any order.
  static GraphStorage from_edges(const NodeSet& nodes, std::vector<std::pair<NodeId, NodeId>> edges);

  /// The arrays of a graph in a file, in node order.
  struct Arrays {
    std::span<const std::uint32_t> count;  ///< entries in each node's row
    std::span<const std::uint32_t> to;     ///< AdjacencyRow::to of all rows
    std::span<const std::uint16_t> bits;   ///< AdjacencyRow::bits of all rows
    std::span<const float> paths;          ///< AdjacencyRow::paths of all rows
    std::span<const Guide> guides = {};    ///< in order; edges to nodes are in the nodes' rows
    std::span<const std::array<std::uint32_t, 2>> guide_edges = {};  ///< see guide_edges()
  };
  /// A graph from arrays. Throws InputError, which names the first entry that is out of order or
  /// range, or is not the same from both ends.
  static GraphStorage from_arrays(const NodeSet& nodes, double plain_unit, const Arrays& arrays);

  /// The same edges, neighbours and guides, to the last bit.
  bool equals(const GraphStorage& other) const;

 private:
  AdjacencyStore& store(std::uint32_t id) { return is_guide(id) ? guide_rows_ : rows_; }
  void add_half_edge(std::uint32_t from, std::uint32_t to, std::uint16_t bound);

  AdjacencyStore rows_, guide_rows_;
  GuideSet guides_;
  std::size_t edges_ = 0;
  double plain_unit_ = 1, longest_edge_ = 0, largest_support_ = 0;
};

}  // namespace geo
