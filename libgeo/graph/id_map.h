// A small hash table that numbers ids in the order in which they come.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace geo {

class IdMap {
 public:
  static constexpr std::uint32_t none = ~0u;
  /// Forgets all ids; `expected`: about how many will come.
  void clear(std::size_t expected) {
    slots_.assign(std::bit_ceil(std::max<std::size_t>(2 * expected, 64)), empty);
    shift_ = 64 - static_cast<unsigned>(std::countr_zero(slots_.size()));
    ids_.clear();
  }
  /// The ids that came, in their order.
  const std::vector<std::uint32_t>& ids() const { return ids_; }
  /// The number of an id, or `none`.
  std::uint32_t find(std::uint32_t id) const {
    for (std::size_t at = place(id);; at = (at + 1) & (slots_.size() - 1))
      if (static_cast<std::uint32_t>(slots_[at]) == id || slots_[at] == empty) return static_cast<std::uint32_t>(slots_[at] >> 32);
  }
  /// The number of an id, which becomes the next one when it is new.
  std::uint32_t add(std::uint32_t id) {
    for (std::size_t at = place(id);; at = (at + 1) & (slots_.size() - 1)) {
      if (static_cast<std::uint32_t>(slots_[at]) == id) return static_cast<std::uint32_t>(slots_[at] >> 32);
      if (slots_[at] != empty) continue;
      const auto number = static_cast<std::uint32_t>(ids_.size());
      slots_[at] = std::uint64_t(number) << 32 | id;
      ids_.push_back(id);
      if (2 * ids_.size() > slots_.size()) grow();
      return number;
    }
  }

 private:
  static constexpr std::uint64_t empty = ~std::uint64_t(0);
  std::size_t place(std::uint32_t id) const { return (id * 0x9e3779b97f4a7c15ull) >> shift_; }
  void grow() {
    slots_.assign(2 * slots_.size(), empty);
    --shift_;
    for (std::uint32_t number = 0; number < ids_.size(); ++number) {
      std::size_t at = place(ids_[number]);
      while (slots_[at] != empty) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = std::uint64_t(number) << 32 | ids_[number];
    }
  }

  std::vector<std::uint64_t> slots_;  // number << 32 | id
  std::vector<std::uint32_t> ids_;
  unsigned shift_ = 64;
};

}  // namespace geo
