// The part of the visibility graph that the neighbourhoods of some sources depend on, densely
// numbered and with lengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/graph_storage.h"
#include "graph/id_numbering.h"

namespace geo {

/// Nodes and guides within a support radius of a source ("local nodes", numbered ascending by id).
/// Also holds the edges between local nodes that shortest paths may use.
class LocalGraph {
 public:
  /// An edge to a local node.
  struct Edge {
    std::uint32_t to, length;  ///< length: warped, below unit_radius
  };
  /// Edges of a node are sorted into classes by length; a class spans 2⁻⁴ of a support radius.
  static constexpr unsigned class_shift = 20;
  /// A class boundary: edges at least this long lead out of the support radius from a node at
  /// `distance`, as do some shorter ones.
  static constexpr std::uint32_t end_of_classes(std::uint32_t distance) {
    return (((unit_radius - 1 - distance) >> class_shift) + 1) << class_shift;
  }

  /// Collects everything within a support radius of a source. `sources` are ascending; fast where
  /// they are near each other.
  void gather(const NodeSet& nodes, const GraphStorage& graph, std::span<const std::uint32_t> sources);

  /// Number of local nodes.
  std::uint32_t size() const { return static_cast<std::uint32_t>(id_.size()); }
  /// Number of local nodes that are nodes of the graph; the guides come behind them.
  std::uint32_t node_count() const { return nodes_; }
  /// The id of a local node in the whole graph.
  std::uint32_t id(std::uint32_t local) const { return id_[local]; }
  /// The local node of the k-th source.
  std::uint32_t source(std::size_t k) const { return local_[k]; }
  /// The position of a local node.
  Vec3 position(std::uint32_t local) const { return {points_[local].x, points_[local].y, points_[local].z}; }
  /// Does the k-th source have edges that join no neighbours? Edges as long as the support are not
  /// in the local graph.
  bool has_edge_only_entries(std::size_t k) const { return edge_only_[k]; }
  /// The edges of a local node by class of length. Edges that lead to no neighbour of a source are
  /// left out.
  std::span<const Edge> edges(std::uint32_t local) const {
    return {edges_.data() + first_[local], edges_.data() + first_[local + 1]};
  }
  /// By local node: from this distance on, none of its edges leads to a neighbour.
  std::span<const std::uint32_t> limits() const { return limit_; }

 private:
  struct Point {
    double x, y, z, radius;
  };
  struct Discovery {
    std::uint32_t id, distance;  // distance: an upper bound of the distance to the nearest source by
                                 // lower bounds of lengths
    std::uint32_t begin, end;    // of its targets
  };
  std::uint32_t discover(std::uint32_t id);
  void explore(const GraphStorage& graph, std::span<const std::uint32_t> sources);
  void measure(std::uint32_t number, bool source);

  // By number, in the order of discovery; sources come first.
  IdNumbering numbers_;
  std::uint32_t discovered_ = 0;
  std::vector<Discovery> discoveries_;
  std::vector<std::uint8_t> queued_, edge_only_;
  std::vector<std::uint32_t> queue_, targets_, next_, local_;
  std::uint32_t nodes_ = 0;
  // By local node.
  std::vector<std::uint32_t> id_, number_, first_, limit_;
  std::vector<Point> points_;
  std::vector<Edge> edges_;  // may be longer than needed
  // Scratch for the edges of one node.
  std::vector<double> squared_, radius_;
  std::vector<std::uint32_t> length_, to_, class_;
};

}  // namespace geo
