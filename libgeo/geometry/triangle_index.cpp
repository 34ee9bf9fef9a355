// Cells of edge 2 · 4^k, one level per k, hashed in blocks of 4³ with linear probing. A bit per
// cell marks finer blocks that hold entries, so that queries skip empty space.
#include "geometry/triangle_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace geo {
namespace {

constexpr int block_shift = 2;  // from coordinates of cells to those of blocks

unsigned cell_in_block(const std::int64_t (&at)[3]) {
  return static_cast<unsigned>((at[0] & 3) | (at[1] & 3) << 2 | (at[2] & 3) << 4);
}

// Clamped, so that a far query does not overflow.
std::int64_t floor_of(double x) {
  const double y = std::clamp(x, -0x1p60, 0x1p60);
  const auto toward_zero = static_cast<std::int64_t>(y);
  return toward_zero - (y < static_cast<double>(toward_zero));
}

template <class Range, class Visit>
void for_each_cell(const Range& r, const Visit& visit) {
  std::int64_t at[3];
  for (at[0] = r.lo[0]; at[0] <= r.hi[0]; ++at[0])
    for (at[1] = r.lo[1]; at[1] <= r.hi[1]; ++at[1])
      for (at[2] = r.lo[2]; at[2] <= r.hi[2]; ++at[2]) visit(at);
}

// The cells of the block at coordinates `at` that lie in a range, one bit a cell.
template <class Range>
std::uint64_t cells_in_range(const std::int64_t (&at)[3], const Range& cells) {
  // The cells of the first layer across each axis.
  constexpr std::uint64_t first_layer[3] = {0x1111111111111111ull, 0x000f000f000f000full, 0xffffull};
  std::uint64_t inside = ~0ull;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t from = std::max<std::int64_t>(cells.lo[i] - 4 * at[i], 0),
                       to = std::min<std::int64_t>(cells.hi[i] - 4 * at[i], 3);
    std::uint64_t layers = 0;
    for (auto layer = from; layer <= to; ++layer) layers |= first_layer[i] << (layer << 2 * i);
    inside &= layers;
  }
  return inside;
}

}  // namespace

// Tests of the plane of a triangle against boxes. They only cull: a box is kept where rounding
// leaves the answer open.
class TriangleIndex::Plane {
 public:
  Plane(const Vec3& a, const Vec3& b, const Vec3& c, const Box3& box, double reach) {
    n_ = (b - a).cross(c - a);
    m_ = n_.cwiseAbs();
    d_ = n_.dot(a);
    m_.maxCoeff(&axis_);
    // The normal of a needle consists of rounding errors: height below 1e-6 of the longest edge.
    // The index then uses the box alone.
    const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    well_defined_ = m_[axis_] > 1e-6 * longest && longest > 1e-200 && longest < 1e200;
    size_ = box.hi.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).maxCoeff();
    reach_ = reach;
  }
  bool well_defined() const { return well_defined_; }
  // The axis closest to the normal.
  int axis() const { return axis_; }
  // Whether a box is farther than `reach` from the plane: |n · middle − d| > Σ |n_i| half_i +
  // (error + reach) Σ |n_i|, where n is not normalised.
  bool clear_of(const Vec3& middle, const Vec3& half) const {
    return std::abs(n_.dot(middle) - d_) > m_.dot(half) + (error_bound(half.maxCoeff()) + reach_) * m_.sum();
  }
  // Calls visit(at) for each grid cube of edge length `size` in the range that the plane may pass
  // through. In each column along axis w:
  // x_w = (d − n_u x_u − n_v x_v) / n_w at the column's centre, ± span.
  template <class Visit>
  void each_cube(const Range& r, double size, const Visit& visit) const {
    const int w = axis_, u = (w + 1) % 3, v = (w + 2) % 3;
    const double span = 0.5 * size * (m_[u] + m_[v]) / m_[w] + error_bound(size) + 2 * reach_;
    std::int64_t at[3];
    for (at[u] = r.lo[u]; at[u] <= r.hi[u]; ++at[u])
      for (at[v] = r.lo[v]; at[v] <= r.hi[v]; ++at[v]) {
        const double pu = (static_cast<double>(at[u]) + 0.5) * size, pv = (static_cast<double>(at[v]) + 0.5) * size;
        const double middle = (d_ - n_[u] * pu - n_[v] * pv) / n_[w];
        const auto from = std::max(r.lo[w], floor_of((middle - span) / size));
        const auto to = std::min(r.hi[w], floor_of((middle + span) / size));
        for (at[w] = from; at[w] <= to; ++at[w]) visit(at);
      }
  }

 private:
  // A well-defined normal has a relative error of about 1e-16 / 1e-6 = 1e-10: ten times that, so
  // that boxes in doubt are kept.
  double error_bound(double cube) const { return 1e-9 * (size_ + cube); }
  Vec3 n_, m_;
  double d_, size_, reach_;
  int axis_ = 0;
  bool well_defined_;
};

// The slot of the block at coordinates `at`, or the empty slot where it belongs.
std::size_t TriangleIndex::Level::slot_of(const std::int64_t (&at)[3]) const {
  const std::size_t mask = slots.size() - 1;
  std::uint64_t h = 0;
  for (const std::int64_t x : at) {
    h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15ull;
    h ^= h >> 32;  // the low bits of a product do not depend on the high bits of its factors
  }
  std::size_t slot = static_cast<std::size_t>(h) & mask;
  while (slots[slot].block != none && !std::equal(at, at + 3, slots[slot].at)) slot = (slot + 1) & mask;
  return slot;
}

TriangleIndex::Block& TriangleIndex::Level::find_or_add_block(const std::int64_t (&at)[3]) {
  if (const Slot& slot = slots[slot_of(at)]; slot.block != none) return blocks[slot.block];
  if (2 * (blocks.size() + 1) > slots.size()) {
    std::vector<Slot> old(2 * slots.size());
    old.swap(slots);
    for (const Slot& s : old)
      if (s.block != none) slots[slot_of(s.at)] = s;
  }
  slots[slot_of(at)] = {{at[0], at[1], at[2]}, static_cast<std::uint32_t>(blocks.size())};
  blocks.emplace_back();
  std::fill(std::begin(blocks.back().first), std::end(blocks.back().first), none);
  return blocks.back();
}

TriangleIndex::Range TriangleIndex::Level::cells_of(const Box3& box) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    r.lo[i] = floor_of(box.lo[i] / cell);
    r.hi[i] = floor_of(box.hi[i] / cell);
  }
  return r;
}

namespace {

int exponent_of(const Box3& box) {
  int exponent = 0;
  std::frexp((box.hi - box.lo).maxCoeff(), &exponent);
  return std::clamp(exponent + 1 + (exponent & 1), -1001, 1001);
}

}  // namespace

std::size_t TriangleIndex::level_of(const Box3& box) const {
  return static_cast<std::size_t>(exponent_of(box) - levels_.front().exponent) / 2;
}

// Ensures that the level with this exponent exists, and all levels between it and the others.
void TriangleIndex::add_levels(int exponent) {
  const auto empty_level = [](int e) {
    return Level{.exponent = e, .cell = std::ldexp(1.0, e), .slots = std::vector<Slot>(64), .blocks = {}};
  };
  if (levels_.empty()) levels_.push_back(empty_level(exponent));
  while (levels_.front().exponent > exponent)
    levels_.insert(levels_.begin(), empty_level(levels_.front().exponent - 2));
  while (levels_.back().exponent < exponent) {
    levels_.push_back(empty_level(levels_.back().exponent + 2));
    const Level& old = levels_[levels_.size() - 2];
    for (const Slot& s : old.slots)
      if (s.block != none && !old.blocks[s.block].empty()) link_to_parents(levels_.size() - 2, s.at);
  }
}

// Marks a block that has received its first entry in the coarser levels.
void TriangleIndex::link_to_parents(std::size_t level, const std::int64_t (&at)[3]) {
  std::int64_t cell[3]{at[0], at[1], at[2]};
  for (++level; level < levels_.size(); ++level) {
    const std::int64_t above[3]{cell[0] >> block_shift, cell[1] >> block_shift, cell[2] >> block_shift};
    Block& block = levels_[level].find_or_add_block(above);
    const bool linked = !block.empty();
    block.below |= 1ull << cell_in_block(cell);
    if (linked) return;
    std::copy(above, above + 3, cell);
  }
}
// Unmarks a block that has lost its last entry in the coarser levels.
void TriangleIndex::unlink_from_parents(std::size_t level, const std::int64_t (&at)[3]) {
  std::int64_t cell[3]{at[0], at[1], at[2]};
  for (++level; level < levels_.size(); ++level) {
    const std::int64_t above[3]{cell[0] >> block_shift, cell[1] >> block_shift, cell[2] >> block_shift};
    Block& block = levels_[level].find_or_add_block(above);
    block.below &= ~(1ull << cell_in_block(cell));
    if (!block.empty()) return;
    std::copy(above, above + 3, cell);
  }
}

// Exact except for the final rounding, since the edge of a cell is a power of two.
TriangleIndex::QuantizedBox TriangleIndex::Level::quantize(const Box3& box, const std::int64_t (&at)[3]) const {
  QuantizedBox result;
  for (int i = 0; i < 3; ++i) {
    const auto round = [&](double x) {
      return static_cast<std::uint8_t>(std::clamp(256 * (x / cell - static_cast<double>(at[i])), 0.0, 255.0));
    };
    result.lo[i] = round(box.lo[i]);
    result.hi[i] = round(box.hi[i]);
  }
  return result;
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) chunks_.reserve(chunks_.size() * count / boxes_.size());
}

void TriangleIndex::insert(std::uint32_t id, const Box3& box) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box;
  add_levels(exponent_of(box));
  const std::size_t at_level = level_of(box);
  Level& level = levels_[at_level];
  for_each_cell(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    const std::int64_t at_block[3]{at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift};
    Block& block = level.find_or_add_block(at_block);
    if (block.empty()) link_to_parents(at_level, at_block);
    const unsigned cell = cell_in_block(at);
    std::uint32_t& first = block.first[cell];
    if (first == none || chunks_[first].id[Chunk::size - 1] != none) {
      std::uint32_t added = free_;
      if (added != none)
        free_ = chunks_[added].next;
      else {
        added = static_cast<std::uint32_t>(chunks_.size());
        chunks_.emplace_back();
      }
      chunks_[added].next = first;
      std::fill(std::begin(chunks_[added].id), std::end(chunks_[added].id), none);
      first = added;
    }
    Chunk& chunk = chunks_[first];
    const auto entry = std::find(std::begin(chunk.id), std::end(chunk.id), none) - std::begin(chunk.id);
    chunk.id[entry] = id;
    chunk.box[entry] = level.quantize(box, at);
    block.filled |= 1ull << cell;
  });
}

void TriangleIndex::erase(std::uint32_t id) {
  const Box3 box = boxes_[id];
  boxes_[id] = Box3{};
  const std::size_t at_level = level_of(box);
  Level& level = levels_[at_level];
  for_each_cell(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    const std::int64_t at_block[3]{at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift};
    Block& block = level.blocks[level.block_at(at_block)];
    const unsigned cell = cell_in_block(at);
    Chunk& first = chunks_[block.first[cell]];
    // The last entry of the first chunk replaces the erased one.
    int last = Chunk::size - 1;
    while (first.id[last] == none) --last;
    for (std::uint32_t b = block.first[cell];; b = chunks_[b].next) {
      Chunk& chunk = chunks_[b];
      const auto entry = std::find(std::begin(chunk.id), std::end(chunk.id), id) - std::begin(chunk.id);
      if (entry == Chunk::size) continue;
      chunk.id[entry] = first.id[last];
      chunk.box[entry] = first.box[last];
      break;
    }
    first.id[last] = none;
    if (last > 0) return;
    const std::uint32_t empty = block.first[cell];
    block.first[cell] = first.next;
    first.next = free_;
    free_ = empty;
    if (block.first[cell] != none) return;
    block.filled &= ~(1ull << cell);
    if (block.empty()) unlink_from_parents(at_level, at_block);
  });
}

// Visits the entries of a block, and of finer blocks within it, in cells that meet the box and
// the plane.
template <class Visit>
void TriangleIndex::visit_block(std::size_t at_level, const std::int64_t (&at)[3], const Box3& box, const Plane* plane,
                                const Visit& visit) const {
  const Level& level = levels_[at_level];
  const auto found = level.block_at(at);
  if (found == none) return;
  const Block& block = level.blocks[found];
  if (block.empty()) return;
  for (std::uint64_t cells = (block.filled | block.below) & cells_in_range(at, level.cells_of(box)); cells;
       cells &= cells - 1) {
    const int cell = std::countr_zero(cells);
    const std::int64_t cell_at[3]{at[0] * side + (cell & 3), at[1] * side + (cell >> 2 & 3),
                                  at[2] * side + (cell >> 4)};
    if (plane) {
      const Vec3 middle =
          level.cell * Vec3(static_cast<double>(cell_at[0]) + 0.5, static_cast<double>(cell_at[1]) + 0.5,
                            static_cast<double>(cell_at[2]) + 0.5);
      if (plane->clear_of(middle, Vec3::Constant(0.5 * level.cell))) continue;
    }
    if (block.filled >> cell & 1) {
      const QuantizedBox query = level.quantize(box, cell_at);
      for (auto b = block.first[cell]; b != none; b = chunks_[b].next) {
        const Chunk& chunk = chunks_[b];
        for (int i = 0; i < Chunk::size && chunk.id[i] != none; ++i)
          if (chunk.box[i].meets(query)) visit(chunk.id[i]);
      }
    }
    if (block.below >> cell & 1) visit_block(at_level - 1, cell_at, box, plane, visit);
  }
}

// Visits from the coarsest level down; then sorts what `visit` has appended to `out` and removes
// duplicates.
template <class Visit>
void TriangleIndex::search(const Box3& box, const Plane* plane, const Visit& visit,
                           std::vector<std::uint32_t>& out) const {
  if (levels_.empty()) return;
  const std::size_t first = out.size(), top = levels_.size() - 1;
  const Level& level = levels_[top];
  const Range blocks = level.cells_of(box).shifted(block_shift);
  const auto visit_at = [&](const std::int64_t(&at)[3]) { visit_block(top, at, box, plane, visit); };
  // A plane passes through about two blocks of each column along its axis.
  const double columns = plane ? double(blocks.hi[plane->axis()] - blocks.lo[plane->axis()] + 1) : 1;
  if (blocks.count() > columns * static_cast<double>(level.slots.size())) {
    for (const Slot& slot : level.slots)
      if (slot.block != none) visit_at(slot.at);
  } else if (plane) {
    plane->each_cube(blocks, side * level.cell, visit_at);
  } else {
    for_each_cell(blocks, visit_at);
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

void TriangleIndex::find(const Box3& box, std::vector<std::uint32_t>& out) const {
  if (box.empty()) return;
  search(
      box, nullptr,
      [&](std::uint32_t id) {
        if (boxes_[id].meets(box)) out.push_back(id);
      },
      out);
}

void TriangleIndex::find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach,
                                       std::vector<std::uint32_t>& out) const {
  const Box3 box = box_of(a, b, c).grown(reach);
  const Plane plane(a, b, c, box, reach);
  if (!plane.well_defined()) return find(box, out);
  search(
      box, &plane,
      [&](std::uint32_t id) {
        const Box3& other = boxes_[id];
        if (other.meets(box) && !plane.clear_of(0.5 * (other.lo + other.hi), 0.5 * (other.hi - other.lo)))
          out.push_back(id);
      },
      out);
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
