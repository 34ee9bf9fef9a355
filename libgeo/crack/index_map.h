// A hash map from keys to indices, without erasure.
#pragma once

#include <cstdint>
#include <vector>

namespace geo::crack {

/// Open addressing with linear probing. `Hash` must spread its bits. The values are indices; ~0u
/// stands for none.
template <class Key, class Hash>
class IndexMap {
 public:
  /// The index of the key; for a new key ~0u, which the caller sets before the next call.
  std::uint32_t& operator[](const Key& key) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[slot_of(key)];
    if (slot.value == none) {
      slot.key = key;
      ++used_;
    }
    return slot.value;
  }
  /// The index of the key, ~0u for an unknown one.
  std::uint32_t find(const Key& key) const { return slots_.empty() ? none : slots_[slot_of(key)].value; }

 private:
  static constexpr std::uint32_t none = ~0u;
  struct Slot {
    Key key{};
    std::uint32_t value = none;
  };
  std::size_t slot_of(const Key& key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = Hash()(key) & mask;
    while (slots_[at].value != none && !(slots_[at].key == key)) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.value != none) slots_[slot_of(s.key)] = s;
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

/// Fibonacci hash of an integer.
struct SpreadHash {
  /// The hash of x.
  std::size_t operator()(std::uint64_t x) const {
    x *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(x ^ x >> 32);
  }
};

}  // namespace geo::crack
