// Memory of the graph's edges that goes over to rows of neighbours while these are found.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "graph/graph_storage.h"
#include "kerf/vec.h"

namespace geo {

/// Which blocks of a graph's rows the searches from runs of nodes may read, by boxes: when the last
/// run that may read a block is done, its memory is given to the store that is being filled.
class BlockRelease {
 public:
  /// Run c is of the nodes from c · `run` on, `run` of them or those that are left.
  BlockRelease(const NodeSet& nodes, GraphStorage& graph, std::size_t run, AdjacencyStore& to);
  /// Called once for each run, when its rows are in the store; from several threads.
  void done(std::size_t run);

 private:
  GraphStorage& graph_;
  AdjacencyStore& to_;
  std::vector<Box3> read_, blocks_;               // what each run may read, and what is in each block
  std::vector<std::atomic<std::uint32_t>> runs_;  // of each block, so many are left
};

}  // namespace geo
