#include "geometry/triangle_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace geo {
namespace {

// From cells to blocks.
constexpr int block_shift = 2;

std::uint64_t block_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & mask) << 42 | (static_cast<std::uint64_t>(y) & mask) << 21 |
         (static_cast<std::uint64_t>(z) & mask);
}

unsigned cell_in_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<unsigned>((x & 3) | (y & 3) << 2 | (z & 3) << 4);
}

// The floor, clamped so that a far query does not overflow.
std::int64_t lower_integer(double x) {
  const double y = std::clamp(x, -1e15, 1e15);
  const auto toward_zero = static_cast<std::int64_t>(y);
  return toward_zero - (y < static_cast<double>(toward_zero));
}

template <class Range, class Visit>
void each_place(const Range& r, const Visit& visit) {
  std::int64_t at[3];
  for (at[0] = r.lo[0]; at[0] <= r.hi[0]; ++at[0])
    for (at[1] = r.lo[1]; at[1] <= r.hi[1]; ++at[1])
      for (at[2] = r.lo[2]; at[2] <= r.hi[2]; ++at[2]) visit(at);
}

// The cells of the block at a place that lie in a range, as bits.
template <class Range>
std::uint64_t cells_in_range(const std::int64_t (&at)[3], const Range& cells) {
  constexpr std::uint64_t every[3] = {0x1111111111111111ull, 0x000f000f000f000full, 0xffffull};  // one layer across an axis
  std::uint64_t inside = ~0ull;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t from = std::max<std::int64_t>(cells.lo[i] - 4 * at[i], 0), to = std::min<std::int64_t>(cells.hi[i] - 4 * at[i], 3);
    std::uint64_t layers = 0;
    for (auto layer = from; layer <= to; ++layer) layers |= every[i] << (layer << 2 * i);
    inside &= layers;
  }
  return inside;
}

}  // namespace

// A triangle's plane against cubes. All tests are for speed alone, so they keep what rounding leaves in doubt.
class TriangleIndex::Plane {
 public:
  Plane(const Vec3& a, const Vec3& b, const Vec3& c, const Box3& box, double reach) {
    n_ = (b - a).cross(c - a);
    m_ = n_.cwiseAbs();
    d_ = n_.dot(a);
    m_.maxCoeff(&axis_);
    // The normal of a needle is rounding and nothing else.
    const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    known_ = m_[axis_] > 1e-6 * longest && longest > 1e-200 && longest < 1e200;
    size_ = box.hi.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).maxCoeff();
    reach_ = reach;
  }
  bool known() const { return known_; }
  /// The axis that the plane is steepest to.
  int axis() const { return axis_; }
  bool clear_of(const Vec3& middle, const Vec3& half) const {
    return std::abs(n_.dot(middle) - d_) > m_.dot(half) + (doubt(half.maxCoeff()) + reach_) * m_.sum();
  }
  /// Calls for each cube of edge length `size` in the range that the plane may pass through.
  template <class Visit>
  void each_cube(const Range& r, double size, const Visit& visit) const {
    const int w = axis_, u = (w + 1) % 3, v = (w + 2) % 3;
    const double span = 0.5 * size * (m_[u] + m_[v]) / m_[w] + doubt(size) + 2 * reach_;
    std::int64_t at[3];
    for (at[u] = r.lo[u]; at[u] <= r.hi[u]; ++at[u])
      for (at[v] = r.lo[v]; at[v] <= r.hi[v]; ++at[v]) {
        const double pu = (static_cast<double>(at[u]) + 0.5) * size, pv = (static_cast<double>(at[v]) + 0.5) * size;
        const double middle = (d_ - n_[u] * pu - n_[v] * pv) / n_[w];
        const auto from = std::max(r.lo[w], lower_integer((middle - span) / size));
        const auto to = std::min(r.hi[w], lower_integer((middle + span) / size));
        for (at[w] = from; at[w] <= to; ++at[w]) visit(at);
      }
  }

 private:
  double doubt(double cube) const { return 1e-9 * (size_ + cube); }
  Vec3 n_, m_;
  double d_, size_, reach_;
  int axis_ = 0;
  bool known_;
};

// Where the key is, or the empty slot where it would go.
std::size_t TriangleIndex::Level::slot_of(std::uint64_t key) const {
  const std::size_t mask = slots.size() - 1;
  std::uint64_t h = key * 0x9e3779b97f4a7c15ull;  // the low bits of a product know nothing of the key's high ones
  h ^= h >> 32;
  std::size_t at = static_cast<std::size_t>(h) & mask;
  while (slots[at].key != key && slots[at].key != ~0ull) at = (at + 1) & mask;
  return at;
}

std::uint32_t TriangleIndex::Level::block_at(std::int64_t x, std::int64_t y, std::int64_t z) const { return slots[slot_of(block_key(x, y, z))].block; }

TriangleIndex::Block& TriangleIndex::Level::make_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto key = block_key(x, y, z);
  if (const Slot& slot = slots[slot_of(key)]; slot.block != none) return blocks[slot.block];
  if (2 * (blocks.size() + 1) > slots.size()) {
    std::vector<Slot> old(2 * slots.size());
    old.swap(slots);
    for (const Slot& s : old)
      if (s.block != none) slots[slot_of(s.key)] = s;
  }
  slots[slot_of(key)] = {key, static_cast<std::uint32_t>(blocks.size())};
  blocks.emplace_back();
  std::fill(std::begin(blocks.back().first), std::end(blocks.back().first), none);
  return blocks.back();
}

TriangleIndex::Range TriangleIndex::Level::cells_of(const Box3& box) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    // Keys wrap around; boxes decide.
    r.lo[i] = lower_integer(box.lo[i] / cell);
    r.hi[i] = lower_integer(box.hi[i] / cell);
  }
  return r;
}

TriangleIndex::Level& TriangleIndex::level_of(const Box3& box) {
  int exponent = 0;
  std::frexp((box.hi - box.lo).maxCoeff(), &exponent);
  exponent = std::clamp(exponent + 1 + (exponent & 1), -1001, 1001);
  const auto at = std::lower_bound(levels_.begin(), levels_.end(), exponent, [](const Level& l, int e) { return l.exponent < e; });
  if (at != levels_.end() && at->exponent == exponent) return *at;
  return *levels_.insert(at, Level{exponent, std::ldexp(1.0, exponent), 0, std::vector<Slot>(64), {}});
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) entries_.reserve(entries_.size() * count / boxes_.size());
}

void TriangleIndex::insert(std::uint32_t id, const Box3& box) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box;
  Level& level = level_of(box);
  each_place(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    Block& block = level.make_block(at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift);
    std::uint32_t entry = free_;
    if (entry != none)
      free_ = entries_[entry].next;
    else
      entry = static_cast<std::uint32_t>(entries_.size()), entries_.emplace_back();
    const unsigned cell = cell_in_block(at[0], at[1], at[2]);
    entries_[entry] = {id, block.first[cell]};
    ++level.entries;
    block.first[cell] = entry;
    block.filled |= 1ull << cell;
  });
}

void TriangleIndex::erase(std::uint32_t id) {
  const Box3 box = boxes_[id];
  boxes_[id] = Box3{};
  Level& level = level_of(box);
  each_place(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    Block& block = level.blocks[level.block_at(at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift)];
    const unsigned cell = cell_in_block(at[0], at[1], at[2]);
    std::uint32_t* link = &block.first[cell];
    while (entries_[*link].id != id) link = &entries_[*link].next;
    const std::uint32_t entry = *link;
    *link = entries_[entry].next;
    entries_[entry].next = free_;
    free_ = entry;
    --level.entries;
    if (block.first[cell] == none) block.filled &= ~(1ull << cell);
  });
}

// What the filled cells of the block at a place hold, those in the range and not clear of the plane.
template <class Take>
void TriangleIndex::visit(const Level& level, const std::int64_t (&at)[3], const Range& cells, const Plane* plane, const Take& take) const {
  const auto found = level.block_at(at[0], at[1], at[2]);
  if (found == none) return;
  const Block& block = level.blocks[found];
  if (!block.filled) return;
  for (std::uint64_t filled = block.filled & cells_in_range(at, cells); filled; filled &= filled - 1) {
    const int cell = std::countr_zero(filled);
    if (plane) {
      const std::int64_t x = at[0] * side + (cell & 3), y = at[1] * side + (cell >> 2 & 3), z = at[2] * side + (cell >> 4);
      const Vec3 middle = level.cell * Vec3(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5);
      if (plane->clear_of(middle, Vec3::Constant(0.5 * level.cell))) continue;
    }
    for (auto e = block.first[cell]; e != none; e = entries_[e].next) take(entries_[e].id);
  }
}

template <class Take>
void TriangleIndex::visit_all(const Level& level, const Take& take) const {
  for (const Block& block : level.blocks)
    for (std::uint64_t filled = block.filled; filled; filled &= filled - 1)
      for (auto e = block.first[std::countr_zero(filled)]; e != none; e = entries_[e].next) take(entries_[e].id);
}

void TriangleIndex::find(const Box3& box, std::vector<std::uint32_t>& out) const {
  if (box.empty()) return;
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    if (boxes_[id].meets(box)) out.push_back(id);
  };
  for (const Level& level : levels_) {
    const Range cells = level.cells_of(box);
    const Range blocks = cells.shifted(block_shift);
    if (4 * blocks.count() > static_cast<double>(level.entries)) {
      visit_all(level, take);
      continue;
    }
    each_place(blocks, [&](const std::int64_t(&at)[3]) { visit(level, at, cells, nullptr, take); });
  }
  keep_each_once(out, first);
}

void TriangleIndex::keep_each_once(std::vector<std::uint32_t>& out, std::size_t first) {
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

void TriangleIndex::find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<std::uint32_t>& out) const {
  const Box3 box = box_of(a, b, c).grown(reach);
  const Plane plane(a, b, c, box, reach);
  if (!plane.known()) return find(box, out);
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    const Box3& other = boxes_[id];
    if (other.meets(box) && !plane.clear_of(0.5 * (other.lo + other.hi), 0.5 * (other.hi - other.lo))) out.push_back(id);
  };
  for (const Level& level : levels_) {
    const Range cells = level.cells_of(box);
    const Range blocks = cells.shifted(block_shift);
    // Blocks that the plane passes through are about two to a column; a block costs as much as a few entries.
    const int w = plane.axis();
    if (8 * blocks.count() / double(blocks.hi[w] - blocks.lo[w] + 1) > static_cast<double>(level.entries))
      visit_all(level, take);
    else
      plane.each_cube(blocks, side * level.cell, [&](const std::int64_t(&at)[3]) { visit(level, at, cells, &plane, take); });
  }
  keep_each_once(out, first);
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
