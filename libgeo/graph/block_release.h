// Reuse of the memory of edge rows for rows with neighbours, while these are found.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "graph/graph_storage.h"
#include "kerf/vec.h"

namespace geo {

/// Knows by bounding boxes which blocks of a graph's rows the searches from each run of nodes may
/// read. When the last run that may read a block is done, the block's memory goes to the store
/// being filled.
class BlockRelease {
 public:
  /// Run c: nodes c · run_length to min((c + 1) · run_length, n) − 1. `to`: the store being filled.
  BlockRelease(const NodeSet& nodes, GraphStorage& graph, std::size_t run_length, AdjacencyStore& to);
  /// To be called once for each run, when its rows are stored; safe from several threads.
  void done(std::size_t run);

 private:
  GraphStorage& graph_;
  AdjacencyStore& to_;
  std::vector<Box3> read_, blocks_;                  // what each run may read; what each block holds
  std::vector<std::atomic<std::uint32_t>> readers_;  // by block: runs that may still read it
};

}  // namespace geo
