// An arena of adjacency rows: no allocation for each row, and rows grow and shrink in place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/graph.h"

namespace geo {

/// Adjacency rows in blocks of a megabyte. Memory that a row releases is kept by size and used
/// again. Offsets are 32-bit counts of 8-byte words, so a store holds up to 32 GiB. Not safe to
/// change from several threads, except by Writers.
class AdjacencyStore {
 public:
  /// Entries that one row may have: 16 bits count its words.
  static constexpr std::size_t max_entries = 50000;

  /// A store without rows.
  AdjacencyStore() = default;
  /// Copies rows and blocks; blocks that wait to be used (give_block()) are not copied.
  AdjacencyStore(const AdjacencyStore& o);
  /// Takes the rows of `o`.
  AdjacencyStore(AdjacencyStore&& o) noexcept { swap(o); }
  /// Takes the rows of `o`.
  AdjacencyStore& operator=(AdjacencyStore o) noexcept {
    swap(o);
    return *this;
  }
  /// Exchanges all rows; blocks that wait to be used stay.
  void swap(AdjacencyStore& o) noexcept;

  /// Number of rows.
  std::size_t size() const { return locations_.size(); }
  /// Sets the number of rows; new rows are empty.
  void resize(std::size_t rows) { locations_.resize(rows); }
  /// Row i. Valid until a row is set.
  AdjacencyRow row(std::size_t i) const;
  /// Row i without `paths`: faster.
  AdjacencyRow entries(std::size_t i) const {
    const Location& location = locations_[i];
    if (location.count == 0) return {};
    const auto* to = reinterpret_cast<const std::uint32_t*>(at(location.offset));
    return {{to, location.count}, {reinterpret_cast<const std::uint16_t*>(to + location.count), location.count}, {}};
  }
  /// A lower bound, in units of AdjacencyRow::bound_bits, of the lengths of row i's edges.
  std::uint16_t lowest_bound(std::size_t i) const { return locations_[i].lowest_bound & 0x7fff; }
  /// Did row i, when it was set, have an edge that joins no neighbours?
  bool has_edge_only_entries(std::size_t i) const { return locations_[i].lowest_bound >> 15; }
  /// Prefetches the location of row i.
  void prefetch_location(std::size_t i) const { __builtin_prefetch(&locations_[i]); }
  /// Prefetches the entries of row i; its location should be in the cache.
  void prefetch(std::size_t i) const {
    const Location& location = locations_[i];
    if (location.count == 0) return;
    const std::byte* row = at(location.offset);
    for (std::size_t byte = 0; byte < 6u * location.count; byte += 64) {
      __builtin_prefetch(row + byte);
      asm volatile("");  // gcc removes loops that only prefetch
    }
  }
  /// The bits of row i, to be changed in place: no entry may gain or lose its path.
  std::span<std::uint16_t> bits(std::size_t i);
  /// Sets the bound of an entry of row i.
  void set_bound(std::size_t i, std::size_t entry, std::uint16_t bound);
  /// Replaces row i. Precondition: `row` does not lie in this store. Throws InputError for more
  /// than max_entries.
  void set(std::size_t i, const AdjacencyRow& row);

  /// The block that holds row i, numbered from 0. Precondition: the row is not empty.
  std::uint32_t block_of(std::size_t i) const { return locations_[i].offset >> block_shift; }
  /// Number of blocks.
  std::size_t block_count() const { return blocks_.size(); }
  /// Moves the memory of a block to a store that is being filled. Rows in the block must not be
  /// read again.
  void give_block(std::uint32_t block, AdjacencyStore& to);
  /// Frees blocks that were given to this store and not used.
  void drop_spare() { spare_.clear(); }
  /// Bytes that the store holds, free space included.
  std::size_t bytes() const;

  /// Fills empty rows from several threads: one writer for each thread, no row twice.
  class Writer {
   public:
    /// Writes to `store`, which must outlive the writer.
    explicit Writer(AdjacencyStore& store) : store_(store) {}
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    /// Sets row i, which is empty. Throws InputError for more than max_entries.
    void set(std::size_t i, const AdjacencyRow& row);

   private:
    AdjacencyStore& store_;
    std::uint32_t block_ = ~0u, begin_ = 0, end_ = 0;  // the free words of a block
    std::byte* words_ = nullptr;                       // of that block
  };

 private:
  struct Location {
    std::uint32_t offset = 0;
    std::uint16_t count = 0, words = 0;   // entries; words reserved for the row
    std::uint16_t lowest_bound = 0x7fff;  // uppermost bit: has_edge_only_entries()
  };
  struct FreeWords {
    std::uint32_t block, begin, end;
  };
  static constexpr unsigned block_shift = 17;  // words of a block, as a power of two
  static constexpr std::size_t word = 8;       // bytes
  static std::uint32_t words_for(std::size_t i, const AdjacencyRow& row);
  static void copy(const AdjacencyRow& row, Location& location, std::byte* words);
  std::byte* at(std::uint32_t offset) {
    return blocks_[offset >> block_shift].data() + word * (offset & ((1u << block_shift) - 1));
  }
  const std::byte* at(std::uint32_t offset) const { return const_cast<AdjacencyStore*>(this)->at(offset); }
  std::uint32_t allocate(std::uint32_t& words);
  void release(std::uint32_t offset, std::uint32_t words);
  FreeWords find_free_words(std::uint32_t words);

  std::vector<Location> locations_;
  std::vector<UninitializedArray<std::byte>> blocks_;
  std::vector<std::vector<std::uint32_t>> released_;  // offsets by number of words
  std::vector<FreeWords> open_;                       // blocks that are not full
  std::vector<UninitializedArray<std::byte>> spare_;  // blocks given to this store, not used yet
  std::mutex mutex_;                                  // guards blocks_, released_, open_, spare_ between Writers
};

}  // namespace geo
