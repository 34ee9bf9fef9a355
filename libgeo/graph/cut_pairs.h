// Which edges and pairs of neighbours new faces cut (§ 6.3).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/graph_storage.h"
#include "sampling/node_grid.h"

namespace geo {

/// Those entries of rows between whose ends a face came: each pair from both ends, as long as the
/// graph is what it was.
struct CutPairs {
  struct Entry {
    std::uint32_t to;    ///< node or guide
    std::uint16_t bits;  ///< as in the graph's row
  };
  struct Row {
    std::uint32_t id, begin, end;  ///< whose, and which of `entries`
    bool above;  ///< on which side of the faces, where these have two: those on one side may see each other
  };
  std::vector<Row> rows;       ///< ascending; none is empty
  std::vector<Entry> entries;  ///< ascending in each row
  std::span<const Entry> of(const Row& row) const { return {entries.data() + row.begin, entries.data() + row.end}; }
};

/// Looks among guides and nodes before `first_new`, at a cost that follows the faces' area. `grid`
/// holds all nodes.
CutPairs find_cut_pairs(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                        std::span<const std::array<Vec3, 3>> faces);

}  // namespace geo
