// Numbers ids in the order of their addition, and lists them ascending.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// Faster than a hash table where ids are near each other. Takes a kilobyte (a page) for each run
/// of 256 ids of which one is numbered, and four bytes for each run of the graph.
class IdNumbering {
 public:
  /// Forgets all ids.
  void clear() {
    for (const auto& [run, page] : used_) table(run << shift)[GraphStorage::index_of(run << shift) >> shift] = none;
    used_.clear();
    size_ = 0;
  }
  /// How many ids are numbered.
  std::uint32_t size() const { return size_; }
  /// The number of an id; a new id gets the next one.
  std::uint32_t add(std::uint32_t id) {
    auto& pages = table(id);
    const std::size_t at = GraphStorage::index_of(id) >> shift;
    if (at >= pages.size() || pages[at] == none) open(pages, at, id >> shift);
    auto& number = pages_[pages[at]][id & (length - 1)];
    if (number == none) number = size_++;
    return number;
  }
  /// Calls visit(id, number) for all ids, ascending.
  template <class Visit>
  void each(const Visit& visit) {
    std::sort(used_.begin(), used_.end());
    for (const auto& [run, page] : used_)
      for (std::uint32_t k = 0; k < length; ++k)
        if (pages_[page][k] != none) visit(run << shift | k, pages_[page][k]);
  }

 private:
  static constexpr std::uint32_t none = ~0u, shift = 8, length = 1u << shift;
  using Page = std::array<std::uint32_t, length>;
  std::vector<std::uint32_t>& table(std::uint32_t id) { return tables_[GraphStorage::is_guide(id)]; }
  void open(std::vector<std::uint32_t>& pages, std::size_t at, std::uint32_t run) {
    if (at >= pages.size()) pages.resize(2 * at + 64, none);
    const auto page = static_cast<std::uint32_t>(used_.size());
    if (page == pages_.size()) pages_.emplace_back();
    pages_[page].fill(none);
    used_.push_back({run, pages[at] = page});
  }

  std::vector<std::uint32_t> tables_[2];                       // for nodes and guides: the page of each run, or none
  std::vector<Page> pages_;                                    // numbers
  std::vector<std::pair<std::uint32_t, std::uint32_t>> used_;  // runs and their pages
  std::uint32_t size_ = 0;
};

}  // namespace geo
