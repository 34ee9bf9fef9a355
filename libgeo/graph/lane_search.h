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

/// The edges of a row whose ends may be within a support radius of something that is `reach` or more from here: where they
/// lead, and at least how far that is. Writes up to 16 numbers behind the last, which are nothing. Returns how many there are.
std::size_t edges_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths);

/// The same with the neighbours in place of the edges.
std::size_t neighbors_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths);

class LaneSearch {
 public:
  static constexpr std::size_t lanes = 16;
  struct Found {
    std::uint32_t node, distance;  // local; warped, 0 < distance < unit_radius
  };

  /// Distances along `graph` from up to sixteen of its nodes: label correcting, so they do not depend on any order.
  void run(const LocalGraph& graph, std::span<const std::uint32_t> sources);
  /// Of the k-th source: everything within the support radius but itself, ascending. Until the next run.
  std::span<const Found> row(std::size_t k) const { return {rows_[k].data(), counts_[k]}; }

  struct alignas(64) Lanes {
    std::uint32_t distance[lanes];
  };
  /// What the vector code works on.
  struct Work {
    std::vector<Lanes> distances;        // of each local node; `far` where nothing is known
    std::vector<std::uint8_t> queued;    // 1 where a node is in the queue
    std::vector<std::uint32_t> queue;    // a ring
    std::vector<std::uint8_t> touched;   // 1 where a distance is known; a multiple of eight
    std::uint32_t tail = 0;
  };
  static constexpr std::uint32_t far = 1u << 30;

 private:
  Work work_;
  std::vector<Found> rows_[lanes];
  std::uint32_t counts_[lanes] = {};
};

/// The vector instructions that searches can use here, best first, and the choice of one ("" is the best): all find the
/// same. For tests; call it while no search runs.
std::vector<std::string> vector_targets();
void use_vector_target(const std::string& name);

}  // namespace geo
