// The visibility graph G (§ 6.1) and the neighbours of each node along it (§ 6.2).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/indirect.h"
#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

class GraphStorage;  // private: adjacency rows and guides

/// One support radius in units of warped length (§ 6.4).
constexpr std::uint32_t unit_radius = 1u << 24;

/// A neighbour of a node.
struct Neighbor {
  NodeId to;                 ///< the neighbour
  std::uint32_t warped = 0;  ///< graph distance in 2⁻²⁴ support radii, below unit_radius, rounded
                             ///< down to 2⁻¹⁴ of a radius (§ 6.4)
  float distance = 0;        ///< argument of the kernel, model units: Euclidean where the pair sees each
                             ///< other, else the length of the shortest path
  bool hidden = false;       ///< a face lies between the pair; an edge never joins such a pair
};

/// A view of one adjacency row: an entry for each node that is joined to the row's node by an edge,
/// or is its neighbour, or both. A row may also have entries for edges to guides (§ 8); their ids
/// are above all nodes' ids. Each entry has 16 bits: edge_bit, path_bit, and in the lower 14 bits a
/// lower bound of the warped distance:
///   edge_bit path_bit   meaning
///   1        0          edge, and neighbour that sees the row's node
///   0        0          neighbour that sees the row's node, without an edge
///   0        1          neighbour hidden by a face, with the length of its path in `paths`
///   1        1          edge that joins no neighbours: as long as the support, or to a guide
struct AdjacencyRow {
  std::span<const std::uint32_t> to;    ///< ids at the other ends, ascending
  std::span<const std::uint16_t> bits;  ///< one for each entry
  std::span<const float> paths;         ///< length of the path, in order, for each entry with has_path()

  /// The entry is an edge.
  static constexpr std::uint16_t edge_bit = 1u << 15;
  /// Without edge_bit: a face hides the neighbour. With edge_bit: the edge joins no neighbours.
  static constexpr std::uint16_t path_bit = 1u << 14;
  /// Lower bound of the warped distance, in 2⁻¹⁴ support radii.
  static constexpr std::uint16_t bound_bits = path_bit - 1;

  /// Is the entry an edge?
  static constexpr bool is_edge(std::uint16_t bits) { return bits & edge_bit; }
  /// Is the entry a neighbour?
  static constexpr bool is_neighbor(std::uint16_t bits) {
    return (bits & (edge_bit | path_bit)) != (edge_bit | path_bit);
  }
  /// Is the entry a neighbour hidden by a face, with the length of its path in `paths`?
  static constexpr bool has_path(std::uint16_t bits) { return bits >> 14 == 1; }
  /// At most the warped distance of the pair; for an edge that joins no neighbours, at most its
  /// length.
  static constexpr std::uint32_t bound(std::uint16_t bits) { return std::uint32_t(bits & bound_bits) << 10; }
  /// The bits that hold the bound of a warped distance; both upper bits are 0.
  static constexpr std::uint16_t bits_of_bound(std::uint32_t warped) {
    return static_cast<std::uint16_t>(warped >= unit_radius ? bound_bits : warped >> 10);
  }
};

/// Equal ids, bits and paths.
bool operator==(const AdjacencyRow& a, const AdjacencyRow& b);

/// An undirected graph over nodes with the neighbours of each node. Edges persist however long they
/// are: connectivity does not depend on support radii. Neighbours are symmetric.
/// build_neighborhoods() finds them, update_graph() keeps them. The graph may also have
/// guides (§ 8): Steiner points that shortest paths pass through. Edges, neighbours, components and
/// counts leave guides out.
class VisibilityGraph {
 public:
  /// A graph without nodes.
  VisibilityGraph();

  /// Number of nodes.
  std::size_t node_count() const;
  /// Number of edges between nodes.
  std::size_t edge_count() const;
  /// Number of guides, retired ones included.
  std::size_t guide_count() const;

  class Edges;
  class Neighbors;
  /// The nodes at the other ends of i's edges, ascending: a range of NodeId.
  Edges edges(NodeId i) const;
  /// i's neighbours, ascending, without i itself: a range of Neighbor. `nodes` must be the graph's
  /// nodes and outlive the range.
  Neighbors neighbors(const NodeSet& nodes, NodeId i) const;
  /// Number of i's neighbours.
  std::size_t neighbor_count(NodeId i) const;
  /// Does the edge ij exist?
  bool has_edge(NodeId i, NodeId j) const;
  /// The adjacency row of a node. Valid until the graph changes.
  AdjacencyRow row(NodeId i) const;

  /// Writes the component of each node; returns the number of components. Components are numbered
  /// from 0, ascending by their lowest nodes.
  std::uint32_t components(std::vector<std::uint32_t>& component) const;
  /// Bytes of all rows and guides.
  std::size_t bytes() const;

  /// Ids of guides begin here.
  static constexpr std::uint32_t first_guide = 1u << 31;
  /// Is this the id of a guide?
  static constexpr bool is_guide(std::uint32_t id) { return id >= first_guide; }

 private:
  friend class GraphStorage;  // it alone reaches itself, for the library's own code
  Indirect<GraphStorage> storage_;
};

/// The same edges, neighbours and guides, to the last bit.
bool operator==(const VisibilityGraph& a, const VisibilityGraph& b);

/// The graph of § 6.1: the Euclidean minimum spanning tree and each node's k nearest nodes, without
/// every edge that touches a triangle of `obstacles` (closed semantics, exact). Neighbours are not
/// yet found. Throws InputError for a negative k.
VisibilityGraph build_visibility_graph(const NodeSet& nodes, std::span<const std::array<Vec3, 3>> obstacles, int k,
                                       const Progress& progress = {});

// ---- Neighbours (§ 6.2): all nodes within the support radius along the graph.

/// Algorithm that finds neighbours. All give the same rows, bit for bit.
enum class NeighborMethod {
  automatic,  ///< the fastest: batched label-correcting search
  dijkstra,   ///< Dijkstra's algorithm, bounded by the support radius
  mfw         ///< the paper's modified Floyd–Warshall
};

/// Finds all neighbours of all nodes. The result does not depend on the number of threads or the
/// vector width. Reuses the memory of the edges' rows while it runs: if it throws, the graph is
/// lost.
void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, std::span<const std::array<Vec3, 3>> obstacles,
                         NeighborMethod method = NeighborMethod::automatic, const Progress& progress = {});

// ---- The graph as arrays, for other programs.

/// A relation between nodes in compressed sparse row format, as SciPy's csr_matrix:
/// indices[indptr[i]] up to, not including, indices[indptr[i + 1]] are the nodes related to node i,
/// ascending.
struct CsrArrays {
  std::vector<std::uint64_t> indptr;   ///< node_count + 1 offsets; the first is 0
  std::vector<std::uint32_t> indices;  ///< node ids; each pair appears in both rows
  std::vector<float> distances;        ///< one for each index, model units
};

/// The edges of the graph with their Euclidean lengths. `nodes` must be the graph's nodes.
CsrArrays edge_arrays(const NodeSet& nodes, const VisibilityGraph& graph);
/// The neighbours in the graph with their distances as in Neighbor. `nodes` must be the graph's
/// nodes.
CsrArrays neighbor_arrays(const NodeSet& nodes, const VisibilityGraph& graph);

// ---- Ranges.

/// A range over the entries of a row that are edges between nodes.
class VisibilityGraph::Edges {
 public:
  /// A forward iterator over NodeId.
  class Iterator {
   public:
    /// Starts at entry `at` or the first edge behind it.
    Iterator(const AdjacencyRow& row, std::size_t at) : row_(row), at_(at) { skip(); }
    /// The node at the other end.
    NodeId operator*() const { return NodeId(row_.to[at_]); }
    /// To the next edge.
    Iterator& operator++() {
      ++at_;
      skip();
      return *this;
    }
    /// At different entries of one row?
    bool operator!=(const Iterator& o) const { return at_ != o.at_; }

   private:
    void skip() {
      while (at_ < row_.to.size() && !AdjacencyRow::is_edge(row_.bits[at_])) ++at_;
    }
    AdjacencyRow row_;
    std::size_t at_;
  };
  /// The edges of a row, without those to guides.
  explicit Edges(const AdjacencyRow& row) : row_(row) {
    while (!row_.to.empty() && is_guide(row_.to.back())) row_.to = row_.to.first(row_.to.size() - 1);
  }
  /// The first edge.
  Iterator begin() const { return {row_, 0}; }
  /// Behind the last edge.
  Iterator end() const { return {row_, row_.to.size()}; }

 private:
  AdjacencyRow row_;
};

/// A range over the entries of a row that are neighbours.
class VisibilityGraph::Neighbors {
 public:
  /// A forward iterator over Neighbor.
  class Iterator {
   public:
    /// Starts at entry `at` of node i's row or the first neighbour behind it; `at` is 0 or the
    /// row's size.
    Iterator(const AdjacencyRow& row, const NodeSet& nodes, std::size_t i, std::size_t at)
        : row_(row), nodes_(&nodes), i_(i), at_(at) {
      skip();
    }
    /// The neighbour.
    Neighbor operator*() const {
      const auto to = row_.to[at_];
      const bool hidden = AdjacencyRow::has_path(row_.bits[at_]);
      const float distance =
          hidden ? row_.paths[path_]
                 : static_cast<float>(std::sqrt(squared_distance(nodes_->position[i_], nodes_->position[to])));
      return {.to = NodeId(to), .warped = AdjacencyRow::bound(row_.bits[at_]), .distance = distance, .hidden = hidden};
    }
    /// To the next neighbour.
    Iterator& operator++() {
      path_ += AdjacencyRow::has_path(row_.bits[at_]);
      ++at_;
      skip();
      return *this;
    }
    /// At different entries of one row?
    bool operator!=(const Iterator& o) const { return at_ != o.at_; }

   private:
    void skip() {
      while (at_ < row_.to.size() && !AdjacencyRow::is_neighbor(row_.bits[at_])) ++at_;
    }
    AdjacencyRow row_;
    const NodeSet* nodes_;
    std::size_t i_, at_, path_ = 0;
  };
  /// The neighbours in the row of node i.
  Neighbors(const AdjacencyRow& row, const NodeSet& nodes, NodeId i) : row_(row), nodes_(&nodes), i_(i.index()) {}
  /// The first neighbour.
  Iterator begin() const { return {row_, *nodes_, i_, 0}; }
  /// Behind the last neighbour.
  Iterator end() const { return {row_, *nodes_, i_, row_.to.size()}; }

 private:
  AdjacencyRow row_;
  const NodeSet* nodes_;
  std::size_t i_;
};

}  // namespace geo
