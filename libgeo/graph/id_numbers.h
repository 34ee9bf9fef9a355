// Numbers ids in the order in which they come.
#pragma once

#include <cstdint>
#include <vector>

#include "graph/visibility_graph.h"

namespace geo {

/// Faster than a hash table where ids are near each other. Memory is four to eight bytes a node of the graph, kept from one use to
/// the next; to begin anew takes no time.
class IdNumbers {
 public:
  void clear() { ids_.clear(); }
  /// The number of an id, which becomes the next one when it is new.
  std::uint32_t add(std::uint32_t id) {
    auto& numbers = VisibilityGraph::is_guide(id) ? guides_ : nodes_;
    const std::size_t at = VisibilityGraph::place(id);
    if (at >= numbers.size()) numbers.resize(2 * at + 64);
    const auto number = numbers[at];
    if (number < ids_.size() && ids_[number] == id) return number;  // else it is of an earlier use
    ids_.push_back(id);
    return numbers[at] = static_cast<std::uint32_t>(ids_.size() - 1);
  }
  /// The ids that came, in their order.
  const std::vector<std::uint32_t>& ids() const { return ids_; }

 private:
  std::vector<std::uint32_t> nodes_, guides_, ids_;
};

}  // namespace geo
