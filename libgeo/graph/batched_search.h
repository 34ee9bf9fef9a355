// Shortest paths from sixteen sources at once, one in each lane of a vector.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/local_graph.h"

namespace geo {

/// warped_length() of `count` edges, from squared Euclidean lengths and the larger radius of each
/// edge's ends. All arrays are read and written up to a multiple of 8.
void warped_lengths(const double* squared, const double* radius, std::size_t count, std::uint32_t* lengths);

/// The edges of a row whose other ends may be within the support radius of something at distance
/// `distance` from the row's node. Writes the other ends and lower bounds of their distances; up to
/// 16 numbers behind the last are overwritten. Returns the number of edges found.
std::size_t edges_within_support(const AdjacencyRow& row, std::uint32_t distance, std::uint32_t* targets,
                                 std::uint32_t* distances);

/// As edges_within_support(), for neighbours in place of edges.
std::size_t neighbors_within_support(const AdjacencyRow& row, std::uint32_t distance, std::uint32_t* targets,
                                     std::uint32_t* distances);

/// A bounded label-correcting search from up to sixteen sources: a queue of nodes whose distances
/// fell, one distance a lane. The result does not depend on the order of the queue.
class BatchedSearch {
 public:
  /// Sources of one search.
  static constexpr std::size_t lanes = 16;
  /// All nodes within the support radius of a source, without the source, ascending.
  struct Distances {
    std::span<const std::uint32_t> node;      ///< local nodes
    std::span<const std::uint32_t> id;        ///< their ids in the whole graph
    std::span<const std::uint32_t> distance;  ///< warped, 0 < distance < unit_radius; edge_bit marks nodes
                                              ///< joined to the source by an edge
  };
  /// Set in Distances::distance.
  static constexpr std::uint32_t edge_bit = 1u << 31;
  /// Distance of nodes not reached: above every sum of a distance and a length.
  static constexpr std::uint32_t far = 1u << 30;

  /// Finds the distances from up to sixteen nodes of `graph`.
  void run(const LocalGraph& graph, std::span<const std::uint32_t> sources);
  /// The result for the k-th source. Valid until the next run.
  Distances distances(std::size_t k) const {
    const auto found = [&](const std::vector<std::uint32_t>& all) { return std::span(all).first(scratch_.counts[k]); };
    return {found(scratch_.found[k].node), found(scratch_.found[k].id), found(scratch_.found[k].distance)};
  }

  /// The distances of one node from all sources.
  struct alignas(64) Lanes {
    std::uint32_t distance[lanes];
  };
  /// The arrays that the vector code works on.
  struct Scratch {
    std::vector<Lanes> distances;       ///< by local node; `far` where not reached
    std::vector<std::uint8_t> queued;   ///< 1 for nodes in the queue
    std::vector<std::uint32_t> queue;   ///< a ring of a power of two
    std::vector<std::uint8_t> touched;  ///< 1 for nodes reached; its size is a multiple of 64
    std::vector<std::uint16_t> joined;  ///< by local node, a bit for each source with an edge to it
    std::uint32_t tail = 0;             ///< end of the queue
    /// Nodes found from one source.
    struct Found {
      std::vector<std::uint32_t> node, id, distance;  ///< with space for sixteen more
    };
    Found found[lanes];                ///< by source
    std::uint32_t counts[lanes] = {};  ///< nodes found from each source
  };

 private:
  Scratch scratch_;
};

}  // namespace geo
