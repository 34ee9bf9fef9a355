// Rows of numbers, one a node, in an arena: no allocation a row, and rows grow and shrink.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"

namespace geo {

/// One row: node ids, ascending, with 16 bits each; behind them a float for each entry whose bits say so.
struct RowView {
  std::span<const std::uint32_t> to;
  std::span<const std::uint16_t> bits;
  std::span<const float> paths;
  friend bool operator==(const RowView& a, const RowView& b);
};

/// The arena: blocks of a megabyte, cut into rows. Room that a row gives up is kept by size and given out again. Rows
/// are named by 32-bit offsets in words of 8 bytes, so there may be 32 GiB of them; a row has at most `most_entries`.
class RowStore {
 public:
  static constexpr std::size_t most_entries = 50000;
  /// Entries whose upper two bits are 01 have a float.
  static constexpr bool has_path(std::uint16_t bits) { return bits >> 14 == 1; }

  RowStore() = default;
  RowStore(const RowStore& o);
  RowStore(RowStore&& o) noexcept { swap(o); }
  RowStore& operator=(RowStore o) noexcept {
    swap(o);
    return *this;
  }
  void swap(RowStore& o) noexcept;

  std::size_t size() const { return places_.size(); }
  /// New rows are empty.
  void resize(std::size_t rows) { places_.resize(rows); }
  RowView row(std::size_t i) const;
  /// A row without its floats: faster.
  RowView entries(std::size_t i) const {
    const Place& place = places_[i];
    if (place.count == 0) return {};
    const auto* to = reinterpret_cast<const std::uint32_t*>(at(place.offset));
    return {{to, place.count}, {reinterpret_cast<const std::uint16_t*>(to + place.count), place.count}, {}};
  }
  /// At most the lower 14 bits of each entry whose uppermost bit is set.
  std::uint16_t least(std::size_t i) const { return places_[i].least & 0x7fff; }
  /// Was a row put here with an entry whose upper two bits are set?
  bool has_bare_edges(std::size_t i) const { return places_[i].least >> 15; }
  /// Fetches a row's place, and then what is there, ahead of their use.
  void prefetch_place(std::size_t i) const { __builtin_prefetch(&places_[i]); }
  void prefetch(std::size_t i) const {
    const Place& place = places_[i];
    if (place.count == 0) return;
    const std::byte* row = at(place.offset);
    for (std::size_t byte = 0; byte < 6u * place.count; byte += 64) {
      __builtin_prefetch(row + byte);
      asm volatile("");  // gcc takes out loops that only prefetch
    }
  }
  /// Only the lower bits and the edge bit may be changed: no entry may gain or lose its float.
  std::span<std::uint16_t> bits(std::size_t i);
  /// Changes the lower 14 bits of an entry.
  void set_bound(std::size_t i, std::size_t entry, std::uint16_t bound);
  /// Replaces a row; `row` must not lie in this store. Throws InputError when it has too many entries.
  void set(std::size_t i, const RowView& row);
  /// Rows lie in blocks, numbered from 0: of a row that is not empty.
  std::uint32_t block_of(std::size_t i) const { return places_[i].offset >> block_shift; }
  std::size_t block_count() const { return blocks_.size(); }
  /// Gives a block to a store that is being filled, as room for rows; those that were in it must not be read any more.
  void give_block(std::uint32_t block, RowStore& to);
  /// Frees what was given and not used.
  void drop_spare() { spare_.clear(); }
  /// Bytes that the store holds, free room included.
  std::size_t bytes() const;

  /// Fills rows that are still empty, safely from several threads: one writer each, no row twice.
  class Writer {
   public:
    explicit Writer(RowStore& store) : store_(store) {}
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    void set(std::size_t i, const RowView& row);

   private:
    RowStore& store_;
    std::uint32_t block_ = ~0u, begin_ = 0, end_ = 0;  // the room left in a block
    std::byte* words_ = nullptr;                       // of the block
  };

 private:
  struct Place {
    std::uint32_t offset = 0;
    std::uint16_t count = 0, words = 0;  // entries, and the room that the row has
    std::uint16_t least = 0x7fff;        // the uppermost bit: has_bare_edges()
  };
  struct Room {
    std::uint32_t block, begin, end;
  };
  static constexpr unsigned block_shift = 17;  // words of a block, as a power of two
  static constexpr std::size_t word = 8;       // bytes
  static std::uint32_t words_for(std::size_t i, const RowView& row);
  static void copy(const RowView& row, Place& place, std::byte* to);
  std::byte* at(std::uint32_t offset) {
    return blocks_[offset >> block_shift].data() + word * (offset & ((1u << block_shift) - 1));
  }
  const std::byte* at(std::uint32_t offset) const { return const_cast<RowStore*>(this)->at(offset); }
  std::uint32_t take(std::uint32_t& words);
  void give_back(std::uint32_t offset, std::uint32_t words);
  Room open_room(std::uint32_t words);

  std::vector<Place> places_;
  std::vector<UninitializedArray<std::byte>> blocks_;
  std::vector<std::vector<std::uint32_t>> free_;      // offsets by words
  std::vector<Room> open_;                            // blocks that are not full yet
  std::vector<UninitializedArray<std::byte>> spare_;  // given and not used yet
  std::mutex mutex_;                                  // of blocks_, free_, open_ and spare_, for writers
};

}  // namespace geo
