// The part of the visibility graph that some sources' neighbourhoods can depend on, dense and with
// lengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/graph_storage.h"
#include "graph/id_numbering.h"

namespace geo {

class LocalGraph {
 public:
  struct Edge {
    std::uint32_t to, length;  // warped, < unit_radius
  };
  /// Edges are in classes by length: those of 2⁻⁴ of a support radius, or of two, and so on.
  static constexpr unsigned class_shift = 20;
  /// Edges as long as this lead out of the support radius from there (as do some shorter ones).
  static constexpr std::uint32_t end_of_classes(std::uint32_t distance) {
    return (((unit_radius - 1 - distance) >> class_shift) + 1) << class_shift;
  }

  /// Everything within a support radius of one of the sources (ascending; best near each other).
  void gather(const NodeSet& nodes, const GraphStorage& graph, std::span<const std::uint32_t> sources);

  std::uint32_t size() const { return static_cast<std::uint32_t>(id_.size()); }
  /// Of them, the first so many are nodes; the rest, if any, are guides.
  std::uint32_t node_count() const { return nodes_; }
  /// Nodes and guides of the whole graph, ascending.
  std::uint32_t id(std::uint32_t local) const { return id_[local]; }
  /// Of the k-th source.
  std::uint32_t source(std::size_t k) const { return place_[k]; }
  Vec3 position(std::uint32_t local) const { return {places_[local].x, places_[local].y, places_[local].z}; }
  /// Has the k-th source edges that join no neighbours: as long as the support, which are not here,
  /// or to guides?
  bool has_edge_only_entries(std::size_t k) const { return bare_edges_[k]; }
  /// By class of length. A node has those edges only that lead to a neighbour of a source.
  std::span<const Edge> edges(std::uint32_t local) const {
    return {edges_.data() + first_[local], edges_.data() + first_[local + 1]};
  }
  /// From this distance on, no edge of a node leads to a neighbour. By local node.
  std::span<const std::uint32_t> limits() const { return limit_; }

 private:
  struct Place {
    double x, y, z, radius;
  };
  struct Discovery {
    std::uint32_t id, reach;   // at least as near to a source as this
    std::uint32_t begin, end;  // of its targets
  };
  std::uint32_t discover(std::uint32_t id);
  void explore(const GraphStorage& graph, std::span<const std::uint32_t> sources);
  void measure(std::uint32_t number, bool source);

  // By number, in the order of discovery; sources come first.
  IdNumbering numbers_;
  std::uint32_t discovered_ = 0;
  std::vector<Discovery> discoveries_;
  std::vector<std::uint8_t> queued_, bare_edges_;
  std::vector<std::uint32_t> queue_, targets_, next_, place_;
  std::uint32_t nodes_ = 0;
  // By local node.
  std::vector<std::uint32_t> id_, number_, first_, limit_;
  std::vector<Place> places_;
  std::vector<Edge> edges_;  // and room for more
  // Of one node's edges.
  std::vector<double> squared_, radius_;
  std::vector<std::uint32_t> length_, to_, class_;
};

}  // namespace geo
