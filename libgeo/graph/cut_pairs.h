// Pairs that new faces come between (§ 6.3): edges (E_cut), and neighbours, hidden before or not.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/graph_storage.h"
#include "sampling/node_grid.h"

namespace geo {

/// The cut pairs in rows, each pair from both ends. Valid until the graph changes.
struct CutPairs {
  /// A cut pair, seen from one end.
  struct Entry {
    std::uint32_t to;    ///< the other end: node or guide
    std::uint16_t bits;  ///< AdjacencyRow::bits of the pair
  };
  /// The cut pairs of one node or guide.
  struct Row {
    std::uint32_t id;          ///< node or guide
    std::uint32_t begin, end;  ///< its range of `entries`
    /// Above the middle of the slab in which the id was found first (cut_candidates.h). A hint for
    /// grouping searches: results do not depend on it.
    bool above;
  };
  std::vector<Row> rows;       ///< ascending by id; none is empty
  std::vector<Entry> entries;  ///< ascending in each row
  /// The entries of a row.
  std::span<const Entry> of(const Row& row) const { return {entries.data() + row.begin, entries.data() + row.end}; }
};

/// Searches guides and the nodes before `first_new`, at a cost that follows the area of the faces.
/// Nodes from `first_new` on are new in this step: nothing has an edge to them yet. `grid` is over
/// all nodes. At most one search runs on a thread at a time.
CutPairs find_cut_pairs(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                        std::span<const std::array<Vec3, 3>> faces);

}  // namespace geo
