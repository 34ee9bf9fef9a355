#include "geometry/triangle_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace geo {
namespace {

// A triangle whose box has more columns of cells than this is kept in the list of large ones.
constexpr double most_columns = 4096;

// Bits of a cell's place within its block.
constexpr int block_shift = 2;

std::uint64_t block_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & mask) << 42 | (static_cast<std::uint64_t>(y) & mask) << 21 |
         (static_cast<std::uint64_t>(z) & mask);
}

unsigned cell_in_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<unsigned>((x & 3) | (y & 3) << 2 | (z & 3) << 4);
}

}  // namespace

// A triangle's plane against cubes. All tests are for speed alone, so they keep what rounding leaves in doubt.
class TriangleIndex::Plane {
 public:
  Plane(const Vec3& a, const Vec3& b, const Vec3& c, const Box3& box, double reach, double cell) {
    n_ = (b - a).cross(c - a);
    m_ = n_.cwiseAbs();
    d_ = n_.dot(a);
    m_.maxCoeff(&axis_);
    // The normal of a needle is rounding and nothing else.
    const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    known_ = m_[axis_] > 1e-6 * longest && longest > 1e-200 && longest < 1e200;
    const double doubt = 1e-9 * (box.hi.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).maxCoeff() + cell);
    slack_ = (doubt + reach) * m_.sum();
    span_ = doubt + 2 * reach;
  }
  /// The axis that the plane is steepest to.
  int axis() const { return axis_; }
  bool clear_of(const Vec3& middle, const Vec3& half) const {
    return known_ && std::abs(n_.dot(middle) - d_) > m_.dot(half) + slack_;
  }
  bool clear_of(const Vec3& middle, double half) const { return known_ && std::abs(n_.dot(middle) - d_) > half * m_.sum() + slack_; }
  /// Calls for each cube of edge length `size` in the range that the plane may pass through.
  template <class Visit>
  void each_cube(const Range& r, double size, const Visit& visit) const {
    const int w = axis_, u = (w + 1) % 3, v = (w + 2) % 3;
    std::int64_t at[3];
    for (at[u] = r.lo[u]; at[u] <= r.hi[u]; ++at[u])
      for (at[v] = r.lo[v]; at[v] <= r.hi[v]; ++at[v]) {
        std::int64_t from = r.lo[w], to = r.hi[w];
        if (known_ && to > from) {
          const double pu = (static_cast<double>(at[u]) + 0.5) * size, pv = (static_cast<double>(at[v]) + 0.5) * size;
          const double middle = (d_ - n_[u] * pu - n_[v] * pv) / n_[w], span = 0.5 * size * (m_[u] + m_[v]) / m_[w] + span_;
          from = std::max(from, static_cast<std::int64_t>(std::floor(std::clamp((middle - span) / size, -1e15, 1e15))));
          to = std::min(to, static_cast<std::int64_t>(std::floor(std::clamp((middle + span) / size, -1e15, 1e15))));
        }
        for (at[w] = from; at[w] <= to; ++at[w]) visit(at);
      }
  }
  bool known() const { return known_; }

 private:
  Vec3 n_, m_;
  double d_, slack_, span_;
  int axis_ = 0;
  bool known_;
};

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

TriangleIndex::Block& TriangleIndex::make_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  if (2 * (blocks_.size() + 1) > slots_.size()) grow();
  const auto key = block_key(x, y, z);
  Slot& slot = slots_[slot_of(key)];
  if (slot.block == none) {
    slot = {key, static_cast<std::uint32_t>(blocks_.size())};
    blocks_.emplace_back();
    std::fill(std::begin(blocks_.back().first), std::end(blocks_.back().first), none);
  }
  return blocks_[slot.block];
}

void TriangleIndex::grow() {
  std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
  old.swap(slots_);
  for (const Slot& s : old)
    if (s.block != none) slots_[slot_of(s.key)] = s;
}

// The cells of a box, or with block_shift its blocks.
TriangleIndex::Range TriangleIndex::cells_of(const Box3& box, int shift) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    // Clamped so that a far query does not overflow; keys wrap around, boxes decide.
    r.lo[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.lo[i] / cell_, -1e15, 1e15))) >> shift;
    r.hi[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.hi[i] / cell_, -1e15, 1e15))) >> shift;
  }
  return r;
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) entries_.reserve(entries_.size() * count / boxes_.size());
}

template <class Visit>
bool TriangleIndex::each_cell(const Vec3& a, const Vec3& b, const Vec3& c, const Visit& visit) const {
  const Box3 box = box_of(a, b, c);
  const Plane plane(a, b, c, box, 0, cell_);
  const Range r = cells_of(box, 0);
  const int w = plane.axis();
  if (r.count() / (plane.known() ? double(r.hi[w] - r.lo[w] + 1) : 1.0) > most_columns) return false;
  plane.each_cube(r, cell_, visit);
  return true;
}

void TriangleIndex::insert(std::uint32_t id, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box_of(a, b, c);
  std::int64_t last[3] = {INT64_MIN, 0, 0};
  Block* block = nullptr;
  const bool listed = each_cell(a, b, c, [&](const std::int64_t(&at)[3]) {
    const std::int64_t place[3] = {at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift};
    if (!std::equal(place, place + 3, last)) block = &make_block(place[0], place[1], place[2]), std::copy(place, place + 3, last);
    std::uint32_t entry = free_;
    if (entry != none)
      free_ = entries_[entry].next;
    else
      entry = static_cast<std::uint32_t>(entries_.size()), entries_.emplace_back();
    const unsigned cell = cell_in_block(at[0], at[1], at[2]);
    entries_[entry] = {id, block->first[cell]};
    block->first[cell] = entry;
    block->filled |= 1ull << cell;
  });
  if (!listed) large_.push_back(id);
}

void TriangleIndex::erase(std::uint32_t id, const Vec3& a, const Vec3& b, const Vec3& c) {
  boxes_[id] = Box3{};
  const bool listed = each_cell(a, b, c, [&](const std::int64_t(&at)[3]) {
    Block& block = blocks_[block_at(at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift)];
    const unsigned cell = cell_in_block(at[0], at[1], at[2]);
    std::uint32_t* link = &block.first[cell];
    while (entries_[*link].id != id) link = &entries_[*link].next;
    const std::uint32_t entry = *link;
    *link = entries_[entry].next;
    entries_[entry].next = free_;
    free_ = entry;
    if (block.first[cell] == none) block.filled &= ~(1ull << cell);
  });
  if (!listed) std::erase(large_, id);
}

// What the filled cells of a block that are in the range and not clear of the plane hold; `at`: the block's place.
template <class Take>
void TriangleIndex::visit(const Block& block, const std::int64_t (&at)[3], const Range& cells, const Plane* plane, const Take& take) const {
  for (std::uint64_t filled = block.filled; filled; filled &= filled - 1) {
    const int cell = std::countr_zero(filled);
    const std::int64_t x = at[0] * side + (cell & 3), y = at[1] * side + (cell >> 2 & 3), z = at[2] * side + (cell >> 4);
    if (x < cells.lo[0] || x > cells.hi[0] || y < cells.lo[1] || y > cells.hi[1] || z < cells.lo[2] || z > cells.hi[2]) continue;
    if (plane && plane->clear_of(cell_ * Vec3(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5), 0.5 * cell_)) continue;
    for (auto e = block.first[cell]; e != none; e = entries_[e].next) take(entries_[e].id);
  }
}

void TriangleIndex::find(const Box3& box, std::vector<std::uint32_t>& out) const {
  if (box.empty()) return;
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    if (boxes_[id].meets(box)) out.push_back(id);
  };
  const Range blocks = cells_of(box, block_shift);
  if (blocks.count() > 4.0 * static_cast<double>(blocks_.size()) + 64) {
    // Cheaper to go through all there are.
    for (std::uint32_t id = 0; id < boxes_.size(); ++id)
      if (!boxes_[id].empty()) take(id);
    return;
  }
  const Range cells = cells_of(box, 0);
  std::int64_t at[3];
  for (at[0] = blocks.lo[0]; at[0] <= blocks.hi[0]; ++at[0])
    for (at[1] = blocks.lo[1]; at[1] <= blocks.hi[1]; ++at[1])
      for (at[2] = blocks.lo[2]; at[2] <= blocks.hi[2]; ++at[2])
        if (const auto b = block_at(at[0], at[1], at[2]); b != none) visit(blocks_[b], at, cells, nullptr, take);
  for (const std::uint32_t id : large_) take(id);
  keep_each_once(out, first);
}

void TriangleIndex::keep_each_once(std::vector<std::uint32_t>& out, std::size_t first) {
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

void TriangleIndex::find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<std::uint32_t>& out) const {
  const Box3 box = box_of(a, b, c).grown(reach);
  const Plane plane(a, b, c, box, reach, cell_);
  const Range blocks = cells_of(box, block_shift);
  if (!plane.known() || blocks.count() > 4.0 * static_cast<double>(blocks_.size()) + 64) return find(box, out);
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    const Box3& other = boxes_[id];
    if (other.meets(box) && !plane.clear_of(0.5 * (other.lo + other.hi), 0.5 * (other.hi - other.lo))) out.push_back(id);
  };
  const Range cells = cells_of(box, 0);
  plane.each_cube(blocks, side * cell_, [&](const std::int64_t(&at)[3]) {
    if (const auto found = block_at(at[0], at[1], at[2]); found != none) visit(blocks_[found], at, cells, &plane, take);
  });
  for (const std::uint32_t id : large_) take(id);
  keep_each_once(out, first);
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
