#include "geometry/triangle_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace geo {
namespace {

// A box that covers more cells than this is kept in the list of large ones.
constexpr std::int64_t most_cells = 512;

std::uint64_t block_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & mask) << 42 | (static_cast<std::uint64_t>(y) & mask) << 21 |
         (static_cast<std::uint64_t>(z) & mask);
}

unsigned cell_in_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<unsigned>((x & 3) | (y & 3) << 2 | (z & 3) << 4);
}

}  // namespace

// Where the key is, or the empty slot where it would go.
std::size_t TriangleIndex::slot_of(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::uint64_t h = key * 0x9e3779b97f4a7c15ull;  // the low bits of a product know nothing of the key's high ones
  h ^= h >> 32;
  std::size_t at = static_cast<std::size_t>(h) & mask;
  while (slots_[at].key != key && slots_[at].key != ~0ull) at = (at + 1) & mask;
  return at;
}

std::uint32_t TriangleIndex::block_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
  return slots_.empty() ? none : slots_[slot_of(block_key(x, y, z))].block;
}

void TriangleIndex::grow() {
  std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
  old.swap(slots_);
  for (const Slot& s : old)
    if (s.block != none) slots_[slot_of(s.key)] = s;
}

TriangleIndex::Range TriangleIndex::cells_of(const Box3& box) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    // Clamped so that a far query does not overflow; keys wrap around, boxes decide.
    r.lo[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.lo[i] / cell_, -1e15, 1e15)));
    r.hi[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.hi[i] / cell_, -1e15, 1e15)));
  }
  return r;
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) entries_.reserve(entries_.size() * count / boxes_.size());
}

void TriangleIndex::insert(std::uint32_t id, const Box3& box) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box;
  const Range r = cells_of(box);
  const double cells = double(r.hi[0] - r.lo[0] + 1) * double(r.hi[1] - r.lo[1] + 1) * double(r.hi[2] - r.lo[2] + 1);
  if (cells > most_cells) {
    large_.push_back(id);
    return;
  }
  std::uint64_t last = ~0ull;
  Block* block = nullptr;
  for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
    for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
      for (auto z = r.lo[2]; z <= r.hi[2]; ++z) {
        if (const auto key = block_key(x >> 2, y >> 2, z >> 2); key != last) {
          if (2 * (blocks_.size() + 1) > slots_.size()) grow();
          Slot& slot = slots_[slot_of(key)];
          if (slot.block == none) {
            slot = {key, static_cast<std::uint32_t>(blocks_.size())};
            blocks_.emplace_back();
            std::fill(std::begin(blocks_.back().first), std::end(blocks_.back().first), none);
          }
          block = &blocks_[slot.block];
          last = key;
        }
        std::uint32_t entry = free_;
        if (entry != none)
          free_ = entries_[entry].next;
        else
          entry = static_cast<std::uint32_t>(entries_.size()), entries_.emplace_back();
        const unsigned cell = cell_in_block(x, y, z);
        entries_[entry] = {id, block->first[cell]};
        block->first[cell] = entry;
        block->filled |= 1ull << cell;
      }
}

void TriangleIndex::erase(std::uint32_t id) {
  const Box3 box = boxes_[id];
  boxes_[id] = Box3{};
  if (const auto it = std::find(large_.begin(), large_.end(), id); it != large_.end()) {
    large_.erase(it);
    return;
  }
  const Range r = cells_of(box);
  for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
    for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
      for (auto z = r.lo[2]; z <= r.hi[2]; ++z) {
        Block& block = blocks_[block_at(x >> 2, y >> 2, z >> 2)];
        const unsigned cell = cell_in_block(x, y, z);
        std::uint32_t* at = &block.first[cell];
        while (entries_[*at].id != id) at = &entries_[*at].next;
        const std::uint32_t entry = *at;
        *at = entries_[entry].next;
        entries_[entry].next = free_;
        free_ = entry;
        if (block.first[cell] == none) block.filled &= ~(1ull << cell);
      }
}

// What the filled cells of a block that are in the range hold; `at`: the block's place.
template <class Take>
void TriangleIndex::visit(const Block& block, const std::int64_t (&at)[3], const Range& r, const Take& take) const {
  for (std::uint64_t filled = block.filled; filled; filled &= filled - 1) {
    const int cell = std::countr_zero(filled);
    const std::int64_t x = at[0] * side + (cell & 3), y = at[1] * side + (cell >> 2 & 3), z = at[2] * side + (cell >> 4);
    if (x < r.lo[0] || x > r.hi[0] || y < r.lo[1] || y > r.hi[1] || z < r.lo[2] || z > r.hi[2]) continue;
    for (auto e = block.first[cell]; e != none; e = entries_[e].next) take(entries_[e].id);
  }
}

void TriangleIndex::find(const Box3& box, std::vector<std::uint32_t>& out) const {
  if (box.empty()) return;
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    if (boxes_[id].meets(box)) out.push_back(id);
  };
  const Range r = cells_of(box);
  const double blocks = double((r.hi[0] >> 2) - (r.lo[0] >> 2) + 1) * double((r.hi[1] >> 2) - (r.lo[1] >> 2) + 1) *
                        double((r.hi[2] >> 2) - (r.lo[2] >> 2) + 1);
  if (blocks > 4.0 * static_cast<double>(blocks_.size()) + 64) {
    // The query is larger than what is there: asking each box is cheaper.
    for (std::uint32_t id = 0; id < boxes_.size(); ++id)
      if (!boxes_[id].empty()) take(id);
  } else {
    std::int64_t at[3];
    for (at[0] = r.lo[0] >> 2; at[0] <= r.hi[0] >> 2; ++at[0])
      for (at[1] = r.lo[1] >> 2; at[1] <= r.hi[1] >> 2; ++at[1])
        for (at[2] = r.lo[2] >> 2; at[2] <= r.hi[2] >> 2; ++at[2])
          if (const auto b = block_at(at[0], at[1], at[2]); b != none) visit(blocks_[b], at, r, take);
    for (const std::uint32_t id : large_) take(id);
  }
  keep_each_once(out, first);
}

void TriangleIndex::keep_each_once(std::vector<std::uint32_t>& out, std::size_t first) {
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

void TriangleIndex::find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<std::uint32_t>& out) const {
  const Box3 box = box_of(a, b, c).grown(reach);
  const Vec3 n = (b - a).cross(c - a);
  const Range r = cells_of(box);
  const double blocks = double((r.hi[0] >> 2) - (r.lo[0] >> 2) + 1) * double((r.hi[1] >> 2) - (r.lo[1] >> 2) + 1) *
                        double((r.hi[2] >> 2) - (r.lo[2] >> 2) + 1);
  int w = 0;
  n.cwiseAbs().maxCoeff(&w);
  const double size = box.hi.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).maxCoeff();
  // The normal of a needle is rounding and nothing else.
  const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  if (!(std::abs(n[w]) > 1e-6 * longest) || !(longest > 1e-200) || blocks > 4.0 * static_cast<double>(blocks_.size()) + 64) return find(box, out);
  const std::size_t first = out.size();
  // All tests are for speed alone, so they keep what rounding leaves in doubt.
  const Vec3 m = n.cwiseAbs();
  const double slack = 1e-9 * m.sum() * (size + cell_) + reach * m.sum(), d = n.dot(a);
  const auto take = [&](std::uint32_t id) {
    const Box3& other = boxes_[id];
    if (!other.meets(box)) return;
    const Vec3 middle = 0.5 * (other.lo + other.hi), half = 0.5 * (other.hi - other.lo);
    if (std::abs(n.dot(middle) - d) <= m.dot(half) + slack) out.push_back(id);
  };
  // Columns of blocks along the axis that the plane is steepest to; in each, those between which it passes.
  const int u = (w + 1) % 3, v = (w + 2) % 3;
  const double block_size = side * cell_;
  std::int64_t at[3];
  for (at[u] = r.lo[u] >> 2; at[u] <= r.hi[u] >> 2; ++at[u])
    for (at[v] = r.lo[v] >> 2; at[v] <= r.hi[v] >> 2; ++at[v]) {
      const double pu = (static_cast<double>(at[u]) + 0.5) * block_size, pv = (static_cast<double>(at[v]) + 0.5) * block_size;
      const double middle = (d - n[u] * pu - n[v] * pv) / n[w];
      const double span = 0.5 * block_size * (m[u] + m[v]) / m[w] + 1e-9 * (size + cell_) + 2 * reach;
      const auto from = std::max(r.lo[w] >> 2, static_cast<std::int64_t>(std::floor(std::clamp((middle - span) / block_size, -1e15, 1e15))));
      const auto to = std::min(r.hi[w] >> 2, static_cast<std::int64_t>(std::floor(std::clamp((middle + span) / block_size, -1e15, 1e15))));
      for (at[w] = from; at[w] <= to; ++at[w]) {
        const auto found = block_at(at[0], at[1], at[2]);
        if (found == none) continue;
        const Block& block = blocks_[found];
        for (std::uint64_t filled = block.filled; filled; filled &= filled - 1) {
          const int cell = std::countr_zero(filled);
          const std::int64_t x = at[0] * side + (cell & 3), y = at[1] * side + (cell >> 2 & 3), z = at[2] * side + (cell >> 4);
          if (x < r.lo[0] || x > r.hi[0] || y < r.lo[1] || y > r.hi[1] || z < r.lo[2] || z > r.hi[2]) continue;
          const Vec3 p = cell_ * Vec3(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5);
          if (std::abs(n.dot(p) - d) > 0.5 * cell_ * m.sum() + slack) continue;
          for (auto e = block.first[cell]; e != none; e = entries_[e].next) take(entries_[e].id);
        }
      }
    }
  for (const std::uint32_t id : large_) take(id);
  keep_each_once(out, first);
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
