// Pairs that new faces cut (§ 6.3): edges (E_cut) and neighbours that lose sight of each other.
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
    bool above;                ///< on which side of the faces, where these have two sides
  };
  std::vector<Row> rows;       ///< ascending by id; none is empty
  std::vector<Entry> entries;  ///< ascending in each row
  /// The entries of a row.
  std::span<const Entry> of(const Row& row) const { return {entries.data() + row.begin, entries.data() + row.end}; }
};

/// Searches guides and the nodes before `first_new`, at a cost that follows the area of the faces.
/// `grid` is over all nodes.
CutPairs find_cut_pairs(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                        std::span<const std::array<Vec3, 3>> faces);

}  // namespace geo
