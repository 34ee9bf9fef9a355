#include "graph/row_store.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "kerf/error.h"

namespace geo {

bool operator==(const RowView& a, const RowView& b) {
  return std::ranges::equal(a.to, b.to) && std::ranges::equal(a.bits, b.bits) && std::ranges::equal(a.paths, b.paths);
}

RowStore::RowStore(const RowStore& o) : places_(o.places_), free_(o.free_), open_(o.open_) {
  for (const auto& block : o.blocks_) {
    UninitializedArray<std::byte> mine(block.size());
    std::copy(block.begin(), block.end(), mine.begin());
    blocks_.push_back(std::move(mine));
  }
}

void RowStore::swap(RowStore& o) noexcept {
  places_.swap(o.places_), blocks_.swap(o.blocks_), free_.swap(o.free_), open_.swap(o.open_);
}

// A row's words: ids, bits, floats, each on a boundary of four bytes.
RowView RowStore::row(std::size_t i) const {
  RowView row = entries(i);
  if (row.to.empty()) return row;
  std::size_t hidden = 0;
  for (const auto bits : row.bits) hidden += has_path(bits);
  row.paths = {reinterpret_cast<const float*>(row.to.data() + row.to.size() + (row.to.size() + 1) / 2), hidden};
  return row;
}

std::span<std::uint16_t> RowStore::bits(std::size_t i) {
  const Place& place = places_[i];
  if (place.count == 0) return {};
  return {reinterpret_cast<std::uint16_t*>(reinterpret_cast<std::uint32_t*>(at(place.offset)) + place.count),
          place.count};
}

void RowStore::set_bound(std::size_t i, std::size_t entry, std::uint16_t bound) {
  auto& entry_bits = bits(i)[entry];
  entry_bits = static_cast<std::uint16_t>((entry_bits & 0xc000) | bound);
  auto& least = places_[i].least;
  least = static_cast<std::uint16_t>((least & 0x8000) | std::min<std::uint16_t>(least & 0x7fff, bound));
}

std::uint32_t RowStore::words_for(std::size_t i, const RowView& row) {
  const std::size_t n = row.to.size();
  if (n > most_entries)
    throw InputError("node " + std::to_string(i) + ": it has " + std::to_string(n) + " neighbours, more than " +
                     std::to_string(most_entries) +
                     "; give the nodes smaller support radii, or fewer nearest neighbours");
  return static_cast<std::uint32_t>((n + (n + 1) / 2 + row.paths.size() + 1) / 2);
}

void RowStore::copy(const RowView& row, Place& place, std::byte* words) {
  auto* to = reinterpret_cast<std::uint32_t*>(words);
  const std::size_t n = row.to.size();
  std::memcpy(to, row.to.data(), n * sizeof(std::uint32_t));
  std::memcpy(to + n, row.bits.data(), n * sizeof(std::uint16_t));
  if (!row.paths.empty()) std::memcpy(to + n + (n + 1) / 2, row.paths.data(), row.paths.size() * sizeof(float));
  std::int16_t least =
      0x7fff;  // above 14 bits where the uppermost is not set; without a branch, so that it is done in vectors
  std::uint16_t bare = 0;
  for (const auto bits : row.bits) {
    least = std::min(least, static_cast<std::int16_t>((bits & 0x3fff) | ((~bits & 0x8000) >> 1)));
    bare |= static_cast<std::uint16_t>(bits & (bits << 1));
  }
  place.count = static_cast<std::uint16_t>(n), place.least = static_cast<std::uint16_t>(least | (bare & 0x8000));
}

RowStore::Room RowStore::open_room(std::uint32_t words) {
  for (std::size_t k = open_.size(); k-- > 0;)
    if (open_[k].end - open_[k].begin >= words) {
      const Room room = open_[k];
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
      return room;
    } else if (open_[k].end - open_[k].begin < (1u << block_shift) / 64) {
      give_back(open_[k].block << block_shift | open_[k].begin, open_[k].end - open_[k].begin);
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
    }
  if (blocks_.size() == std::size_t(1) << (32 - block_shift))
    throw InputError("the graph: it needs more than 32 GiB; use fewer nodes");
  if (spare_.empty()) spare_.emplace_back(word << block_shift);
  blocks_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  return {static_cast<std::uint32_t>(blocks_.size() - 1), 0, 1u << block_shift};
}

void RowStore::give_back(std::uint32_t offset, std::uint32_t words) {
  if (words == 0) return;
  if (free_.size() <= words) free_.resize(words + 1);
  free_[words].push_back(offset);
}

// Room for a row, maybe up to a third more than asked for.
std::uint32_t RowStore::take(std::uint32_t& words) {
  const auto most = std::min<std::size_t>({words + words / 3, std::size_t(0xffff), free_.size() - 1});
  for (std::uint32_t w = words; !free_.empty() && w <= most; ++w)
    if (!free_[w].empty()) {
      const auto offset = free_[w].back();
      free_[w].pop_back();
      words = w;
      return offset;
    }
  Room room = open_room(words);
  const auto offset = room.block << block_shift | room.begin;
  room.begin += words;
  open_.push_back(room);
  return offset;
}

void RowStore::set(std::size_t i, const RowView& row) {
  std::uint32_t words = words_for(i, row);
  Place& place = places_[i];
  if (words > place.words || 3 * words < 2u * place.words) {
    give_back(place.offset, place.words);
    place = {};
    if (words > 0) place.offset = take(words);
    place.words = static_cast<std::uint16_t>(words);
  }
  if (words > 0) copy(row, place, at(place.offset));
}

void RowStore::give_block(std::uint32_t block, RowStore& to) {
  const std::lock_guard lock(to.mutex_);
  to.spare_.push_back(std::exchange(blocks_[block], {}));
}

std::size_t RowStore::bytes() const {
  std::size_t sum = places_.capacity() * sizeof(Place);
  for (const auto& block : blocks_) sum += block.size();
  for (const auto& offsets : free_) sum += sizeof(offsets) + offsets.capacity() * sizeof(std::uint32_t);
  return sum;
}

void RowStore::Writer::set(std::size_t i, const RowView& row) {
  const auto words = words_for(i, row);
  if (words == 0) return;
  if (end_ - begin_ < words) {
    const std::lock_guard lock(store_.mutex_);
    if (block_ != ~0u) store_.open_.push_back({block_, begin_, end_});
    const Room room = store_.open_room(words);
    block_ = room.block, begin_ = room.begin, end_ = room.end, words_ = store_.blocks_[block_].data();
  }
  Place& place = store_.places_[i];
  place.offset = block_ << block_shift | begin_;
  place.words = static_cast<std::uint16_t>(words);
  copy(row, place, words_ + word * begin_);
  begin_ += words;
}

RowStore::Writer::~Writer() {
  if (block_ == ~0u) return;
  const std::lock_guard lock(store_.mutex_);
  store_.open_.push_back({block_, begin_, end_});
}

}  // namespace geo
