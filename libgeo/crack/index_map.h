// Rows by key: a hash table that keeps no nodes and forgets nothing.
#pragma once

#include <cstdint>
#include <vector>

namespace geo::crack {

/// Open addressing with linear probing. `Hash` spreads its bits; values are not ~0u.
template <class Key, class Hash>
class Lookup {
 public:
  /// The value under the key; ~0u where there is none as yet, to be filled in by the caller before
  /// the next call.
  std::uint32_t& operator[](const Key& key) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place(key)];
    if (slot.value == none) slot.key = key, ++used_;
    return slot.value;
  }
  /// The value under the key, ~0u when there is none.
  std::uint32_t find(const Key& key) const { return slots_.empty() ? none : slots_[place(key)].value; }

 private:
  static constexpr std::uint32_t none = ~0u;
  struct Slot {
    Key key{};
    std::uint32_t value = none;
  };
  std::size_t place(const Key& key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = Hash()(key) & mask;
    while (slots_[at].value != none && !(slots_[at].key == key)) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.value != none) slots_[place(s.key)] = s;
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

/// One number from one or two.
struct Spread {
  std::size_t operator()(std::uint64_t x) const {
    x *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(x ^ x >> 32);
  }
};

}  // namespace geo::crack
