// A row is 8-byte words: ids, bits and path lengths, each array aligned to four bytes. Free words
// are lists by size (segregated fits). A row moves when it needs more words than it has, or fewer
// than two thirds of them.
#include "graph/adjacency_store.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "kerf/error.h"

namespace geo {

AdjacencyStore::AdjacencyStore(const AdjacencyStore& o)
    : locations_(o.locations_), released_(o.released_), open_(o.open_) {
  for (const auto& block : o.blocks_) {
    UninitializedArray<std::byte> copied(block.size());
    std::copy(block.begin(), block.end(), copied.begin());
    blocks_.push_back(std::move(copied));
  }
}

void AdjacencyStore::swap(AdjacencyStore& o) noexcept {
  locations_.swap(o.locations_);
  blocks_.swap(o.blocks_);
  released_.swap(o.released_);
  open_.swap(o.open_);
}

// A row in memory: ids, bits, lengths of paths, each aligned to four bytes.
AdjacencyRow AdjacencyStore::row(std::size_t i) const {
  AdjacencyRow row = entries(i);
  if (row.to.empty()) return row;
  std::size_t hidden = 0;
  for (const auto bits : row.bits) hidden += AdjacencyRow::has_path(bits);
  row.paths = {reinterpret_cast<const float*>(row.to.data() + row.to.size() + (row.to.size() + 1) / 2), hidden};
  return row;
}

std::span<std::uint16_t> AdjacencyStore::bits(std::size_t i) {
  const Location& location = locations_[i];
  if (location.count == 0) return {};
  return {reinterpret_cast<std::uint16_t*>(reinterpret_cast<std::uint32_t*>(at(location.offset)) + location.count),
          location.count};
}

void AdjacencyStore::set_bound(std::size_t i, std::size_t entry, std::uint16_t bound) {
  auto& entry_bits = bits(i)[entry];
  entry_bits = static_cast<std::uint16_t>((entry_bits & 0xc000) | bound);
  auto& lowest = locations_[i].lowest_bound;
  lowest = static_cast<std::uint16_t>((lowest & 0x8000) | std::min<std::uint16_t>(lowest & 0x7fff, bound));
}

std::uint32_t AdjacencyStore::words_for(std::size_t i, const AdjacencyRow& row) {
  const std::size_t n = row.to.size();
  if (n > max_entries)
    throw InputError("node " + std::to_string(i) + ": it has " + std::to_string(n) + " neighbours, more than " +
                     std::to_string(max_entries) +
                     "; give the nodes smaller support radii, or fewer nearest neighbours");
  return static_cast<std::uint32_t>((n + (n + 1) / 2 + row.paths.size() + 1) / 2);
}

void AdjacencyStore::copy(const AdjacencyRow& row, Location& location, std::byte* words) {
  auto* to = reinterpret_cast<std::uint32_t*>(words);
  const std::size_t n = row.to.size();
  std::memcpy(to, row.to.data(), n * sizeof(std::uint32_t));
  std::memcpy(to + n, row.bits.data(), n * sizeof(std::uint16_t));
  if (!row.paths.empty()) std::memcpy(to + n + (n + 1) / 2, row.paths.data(), row.paths.size() * sizeof(float));
  // Entries that are no edges count as 0x4000 and more. Without branches, so that it vectorises.
  std::int16_t lowest = 0x7fff;
  std::uint16_t edge_only = 0;
  for (const auto bits : row.bits) {
    lowest = std::min(lowest, static_cast<std::int16_t>((bits & 0x3fff) | ((~bits & 0x8000) >> 1)));
    edge_only |= static_cast<std::uint16_t>(bits & (bits << 1));
  }
  location.count = static_cast<std::uint16_t>(n);
  location.lowest_bound = static_cast<std::uint16_t>(lowest | (edge_only & 0x8000));
}

AdjacencyStore::FreeWords AdjacencyStore::find_free_words(std::uint32_t words) {
  for (std::size_t k = open_.size(); k-- > 0;)
    if (open_[k].end - open_[k].begin >= words) {
      const FreeWords free = open_[k];
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
      return free;
    } else if (open_[k].end - open_[k].begin < (1u << block_shift) / 64) {
      // A block with less than a 64th of its words left is closed; its rest is kept for small rows.
      release(open_[k].block << block_shift | open_[k].begin, open_[k].end - open_[k].begin);
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
    }
  if (blocks_.size() == std::size_t(1) << (32 - block_shift))
    throw InputError("the graph: it needs more than 32 GiB; use fewer nodes");
  if (spare_.empty()) spare_.emplace_back(word << block_shift);
  blocks_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  return {static_cast<std::uint32_t>(blocks_.size() - 1), 0, 1u << block_shift};
}

void AdjacencyStore::release(std::uint32_t offset, std::uint32_t words) {
  if (words == 0) return;
  if (released_.size() <= words) released_.resize(words + 1);
  released_[words].push_back(offset);
}

// The offset of free words for a row, up to a third more than requested; `words` becomes their
// number.
std::uint32_t AdjacencyStore::allocate(std::uint32_t& words) {
  const auto largest = std::min<std::size_t>({words + words / 3, std::size_t(0xffff), released_.size() - 1});
  for (std::uint32_t w = words; !released_.empty() && w <= largest; ++w)
    if (!released_[w].empty()) {
      const auto offset = released_[w].back();
      released_[w].pop_back();
      words = w;
      return offset;
    }
  FreeWords free = find_free_words(words);
  const auto offset = free.block << block_shift | free.begin;
  free.begin += words;
  open_.push_back(free);
  return offset;
}

void AdjacencyStore::set(std::size_t i, const AdjacencyRow& row) {
  std::uint32_t words = words_for(i, row);
  Location& location = locations_[i];
  if (words > location.words || 3 * words < 2u * location.words) {
    release(location.offset, location.words);
    location = {};
    if (words > 0) location.offset = allocate(words);
    location.words = static_cast<std::uint16_t>(words);
  }
  if (words > 0) copy(row, location, at(location.offset));
}

void AdjacencyStore::give_block(std::uint32_t block, AdjacencyStore& to) {
  const std::lock_guard lock(to.mutex_);
  to.spare_.push_back(std::exchange(blocks_[block], {}));
}

std::size_t AdjacencyStore::bytes() const {
  std::size_t sum = locations_.capacity() * sizeof(Location);
  for (const auto& block : blocks_) sum += block.size();
  for (const auto& offsets : released_) sum += sizeof(offsets) + offsets.capacity() * sizeof(std::uint32_t);
  return sum;
}

void AdjacencyStore::Writer::set(std::size_t i, const AdjacencyRow& row) {
  const auto words = words_for(i, row);
  if (words == 0) return;
  if (end_ - begin_ < words) {
    const std::lock_guard lock(store_.mutex_);
    if (block_ != ~0u) store_.open_.push_back({block_, begin_, end_});
    const FreeWords free = store_.find_free_words(words);
    block_ = free.block;
    begin_ = free.begin;
    end_ = free.end;
    words_ = store_.blocks_[block_].data();
  }
  Location& location = store_.locations_[i];
  location.offset = block_ << block_shift | begin_;
  location.words = static_cast<std::uint16_t>(words);
  copy(row, location, words_ + word * begin_);
  begin_ += words;
}

AdjacencyStore::Writer::~Writer() {
  if (block_ == ~0u) return;
  const std::lock_guard lock(store_.mutex_);
  store_.open_.push_back({block_, begin_, end_});
}

}  // namespace geo
