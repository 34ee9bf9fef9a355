// A set of ids of nodes and guides: a bit for each, and a list of the members.
#pragma once

#include <cstdint>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// Faster than a hash table. Takes a bit for each node of the graph, kept from one use to the next;
/// clear() costs as much as there are members.
class IdSet {
 public:
  /// Removes all ids.
  void clear() {
    for (const auto id : ids_) bits_of(id)[word(id)] = 0;
    ids_.clear();
  }
  /// Is the id in the set?
  bool has(std::uint32_t id) const {
    const auto& bits = GraphStorage::is_guide(id) ? guides_ : nodes_;
    return word(id) < bits.size() && (bits[word(id)] >> (id & 63) & 1);
  }
  /// Adds an id.
  void add(std::uint32_t id) {
    auto& bits = bits_of(id);
    if (word(id) >= bits.size()) bits.resize(2 * word(id) + 64, 0);
    const auto bit = std::uint64_t(1) << (id & 63);
    if (bits[word(id)] & bit) return;
    bits[word(id)] |= bit;
    ids_.push_back(id);
  }
  /// The members in the order of their addition.
  const std::vector<std::uint32_t>& ids() const { return ids_; }

 private:
  static std::size_t word(std::uint32_t id) { return GraphStorage::index_of(id) >> 6; }
  std::vector<std::uint64_t>& bits_of(std::uint32_t id) { return GraphStorage::is_guide(id) ? guides_ : nodes_; }
  std::vector<std::uint64_t> nodes_, guides_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace geo
