// Shortest paths from sixteen sources at once, one in each lane of a vector.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graph/local_graph.h"

namespace geo {

/// warped_length() of many edges, from squared distances and the larger radius of each.
void warped_lengths(const double* squared, const double* radius, std::size_t count, std::uint32_t* lengths);

/// The edges of a row whose ends may be within a support radius of something that is `reach` or more from here: where
/// they lead, and at least how far that is. Writes up to 16 numbers behind the last, which are nothing. Returns how
/// many there are.
std::size_t edges_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths);

/// The same with the neighbours in place of the edges.
std::size_t neighbors_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets,
                                   std::uint32_t* lengths);

class LaneSearch {
 public:
  static constexpr std::size_t lanes = 16;
  /// Everything within the support radius of a source but itself, ascending.
  struct Row {
    std::span<const std::uint32_t> node, id;  ///< local, and of the whole graph
    std::span<const std::uint32_t>
        distance;  ///< warped, 0 < distance < unit_radius; and edge_bit where an edge joins it to the source
  };
  static constexpr std::uint32_t edge_bit = 1u << 31;

  /// Distances along `graph` from up to sixteen of its nodes: label correcting, so they do not depend on any order.
  void run(const LocalGraph& graph, std::span<const std::uint32_t> sources);
  /// Of the k-th source. Until the next run.
  Row row(std::size_t k) const {
    const auto part = [&](const std::vector<std::uint32_t>& all) { return std::span(all).first(work_.counts[k]); };
    return {part(work_.rows[k].node), part(work_.rows[k].id), part(work_.rows[k].distance)};
  }

  struct alignas(64) Lanes {
    std::uint32_t distance[lanes];
  };
  /// What the vector code works on.
  struct Work {
    std::vector<Lanes> distances;       // of each local node; `far` where nothing is known
    std::vector<std::uint8_t> queued;   // 1 where a node is in the queue
    std::vector<std::uint32_t> queue;   // a ring
    std::vector<std::uint8_t> touched;  // 1 where a distance is known; a multiple of 64
    std::vector<std::uint16_t> joined;  // of each local node: by bits, the lanes whose sources have an edge to it
    std::uint32_t tail = 0;
    struct Row {
      std::vector<std::uint32_t> node, id, distance;  // and room for sixteen more
    };
    Row rows[lanes];
    std::uint32_t counts[lanes] = {};
  };
  static constexpr std::uint32_t far = 1u << 30;

 private:
  Work work_;
};

/// The vector instructions that searches can use here, best first, and the choice of one ("" is the best): all find the
/// same. For tests; call it while no search runs.
std::vector<std::string> vector_targets();
void use_vector_target(const std::string& name);

}  // namespace geo
