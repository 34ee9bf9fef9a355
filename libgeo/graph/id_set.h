// Which nodes and guides were seen: a bit each, and a list of them.
#pragma once

#include <cstdint>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// Looks an id up faster than a hash table. Memory is a bit a node of the graph, kept from one use
/// to the next; what it takes to begin anew follows what was added.
class IdSet {
 public:
  void clear() {
    for (const auto id : ids_) part(id)[word(id)] = 0;
    ids_.clear();
  }
  bool has(std::uint32_t id) const {
    const auto& bits = GraphStorage::is_guide(id) ? guides_ : nodes_;
    return word(id) < bits.size() && (bits[word(id)] >> (id & 63) & 1);
  }
  void add(std::uint32_t id) {
    auto& bits = part(id);
    if (word(id) >= bits.size()) bits.resize(2 * word(id) + 64, 0);
    const auto bit = std::uint64_t(1) << (id & 63);
    if (bits[word(id)] & bit) return;
    bits[word(id)] |= bit;
    ids_.push_back(id);
  }
  /// In the order in which they came.
  const std::vector<std::uint32_t>& ids() const { return ids_; }

 private:
  static std::size_t word(std::uint32_t id) { return GraphStorage::index_of(id) >> 6; }
  std::vector<std::uint64_t>& part(std::uint32_t id) { return GraphStorage::is_guide(id) ? guides_ : nodes_; }
  std::vector<std::uint64_t> nodes_, guides_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace geo
