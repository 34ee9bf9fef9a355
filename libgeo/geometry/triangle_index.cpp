#include "geometry/triangle_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace geo {
namespace {

// From cells to blocks.
constexpr int block_shift = 2;

unsigned cell_in_block(const std::int64_t (&at)[3]) {
  return static_cast<unsigned>((at[0] & 3) | (at[1] & 3) << 2 | (at[2] & 3) << 4);
}

// The floor, clamped so that a far query does not overflow.
std::int64_t lower_integer(double x) {
  const double y = std::clamp(x, -0x1p60, 0x1p60);
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
  constexpr std::uint64_t every[3] = {0x1111111111111111ull, 0x000f000f000f000full,
                                      0xffffull};  // one layer across an axis
  std::uint64_t inside = ~0ull;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t from = std::max<std::int64_t>(cells.lo[i] - 4 * at[i], 0),
                       to = std::min<std::int64_t>(cells.hi[i] - 4 * at[i], 3);
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

// Where the block at a place is, or the empty slot where it would go.
std::size_t TriangleIndex::Level::slot_of(const std::int64_t (&at)[3]) const {
  const std::size_t mask = slots.size() - 1;
  std::uint64_t h = 0;
  for (const std::int64_t x : at) {
    h = (h ^ static_cast<std::uint64_t>(x)) *
        0x9e3779b97f4a7c15ull;  // the low bits of a product know nothing of the high ones
    h ^= h >> 32;
  }
  std::size_t slot = static_cast<std::size_t>(h) & mask;
  while (slots[slot].block != none && !std::equal(at, at + 3, slots[slot].at)) slot = (slot + 1) & mask;
  return slot;
}

TriangleIndex::Block& TriangleIndex::Level::make_block(const std::int64_t (&at)[3]) {
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
  for (int i = 0; i < 3; ++i) r.lo[i] = lower_integer(box.lo[i] / cell), r.hi[i] = lower_integer(box.hi[i] / cell);
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

// Sees to it that there is a level, and all between it and those there are.
void TriangleIndex::make_levels(int exponent) {
  const auto fresh = [](int e) { return Level{e, std::ldexp(1.0, e), std::vector<Slot>(64), {}}; };
  if (levels_.empty()) levels_.push_back(fresh(exponent));
  while (levels_.front().exponent > exponent) levels_.insert(levels_.begin(), fresh(levels_.front().exponent - 2));
  while (levels_.back().exponent < exponent) {
    levels_.push_back(fresh(levels_.back().exponent + 2));
    const Level& old = levels_[levels_.size() - 2];
    for (const Slot& s : old.slots)
      if (s.block != none && !old.blocks[s.block].empty()) tell_above(levels_.size() - 2, s.at);
  }
}

// A block that has just got its first content is made known to the levels above; one that has lost its last, forgotten.
void TriangleIndex::tell_above(std::size_t level, const std::int64_t (&at)[3]) {
  std::int64_t cell[3]{at[0], at[1], at[2]};
  for (++level; level < levels_.size(); ++level) {
    const std::int64_t above[3]{cell[0] >> block_shift, cell[1] >> block_shift, cell[2] >> block_shift};
    Block& block = levels_[level].make_block(above);
    const bool known = !block.empty();
    block.below |= 1ull << cell_in_block(cell);
    if (known) return;
    std::copy(above, above + 3, cell);
  }
}
void TriangleIndex::forget_above(std::size_t level, const std::int64_t (&at)[3]) {
  std::int64_t cell[3]{at[0], at[1], at[2]};
  for (++level; level < levels_.size(); ++level) {
    const std::int64_t above[3]{cell[0] >> block_shift, cell[1] >> block_shift, cell[2] >> block_shift};
    Block& block = levels_[level].make_block(above);
    block.below &= ~(1ull << cell_in_block(cell));
    if (!block.empty()) return;
    std::copy(above, above + 3, cell);
  }
}

// Exact up to the last floor: a cell's edge is a power of two.
TriangleIndex::Part TriangleIndex::Level::part_of(const Box3& box, const std::int64_t (&at)[3]) const {
  Part part;
  for (int i = 0; i < 3; ++i) {
    const auto place = [&](double x) {
      return static_cast<std::uint8_t>(std::clamp(256 * (x / cell - static_cast<double>(at[i])), 0.0, 255.0));
    };
    part.lo[i] = place(box.lo[i]), part.hi[i] = place(box.hi[i]);
  }
  return part;
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) bunches_.reserve(bunches_.size() * count / boxes_.size());
}

void TriangleIndex::insert(std::uint32_t id, const Box3& box) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box;
  make_levels(exponent_of(box));
  const std::size_t at_level = level_of(box);
  Level& level = levels_[at_level];
  each_place(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    const std::int64_t at_block[3]{at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift};
    Block& block = level.make_block(at_block);
    if (block.empty()) tell_above(at_level, at_block);
    const unsigned cell = cell_in_block(at);
    std::uint32_t& first = block.first[cell];
    if (first == none || bunches_[first].id[Bunch::size - 1] != none) {
      std::uint32_t fresh = free_;
      if (fresh != none)
        free_ = bunches_[fresh].next;
      else
        fresh = static_cast<std::uint32_t>(bunches_.size()), bunches_.emplace_back();
      bunches_[fresh].next = first;
      std::fill(std::begin(bunches_[fresh].id), std::end(bunches_[fresh].id), none);
      first = fresh;
    }
    Bunch& bunch = bunches_[first];
    const auto place = std::find(std::begin(bunch.id), std::end(bunch.id), none) - std::begin(bunch.id);
    bunch.id[place] = id;
    bunch.part[place] = level.part_of(box, at);
    block.filled |= 1ull << cell;
  });
}

void TriangleIndex::erase(std::uint32_t id) {
  const Box3 box = boxes_[id];
  boxes_[id] = Box3{};
  const std::size_t at_level = level_of(box);
  Level& level = levels_[at_level];
  each_place(level.cells_of(box), [&](const std::int64_t(&at)[3]) {
    const std::int64_t at_block[3]{at[0] >> block_shift, at[1] >> block_shift, at[2] >> block_shift};
    Block& block = level.blocks[level.block_at(at_block)];
    const unsigned cell = cell_in_block(at);
    Bunch& first = bunches_[block.first[cell]];
    // The first bunch's last one takes its place.
    int last = Bunch::size - 1;
    while (first.id[last] == none) --last;
    for (std::uint32_t b = block.first[cell];; b = bunches_[b].next) {
      Bunch& bunch = bunches_[b];
      const auto place = std::find(std::begin(bunch.id), std::end(bunch.id), id) - std::begin(bunch.id);
      if (place == Bunch::size) continue;
      bunch.id[place] = first.id[last], bunch.part[place] = first.part[last];
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
    if (block.empty()) forget_above(at_level, at_block);
  });
}

// What a block and those below it hold where it may meet the box and the plane.
template <class Take>
void TriangleIndex::visit(std::size_t at_level, const std::int64_t (&at)[3], const Box3& box, const Plane* plane,
                          const Take& take) const {
  const Level& level = levels_[at_level];
  const auto found = level.block_at(at);
  if (found == none) return;
  const Block& block = level.blocks[found];
  if (block.empty()) return;
  for (std::uint64_t cells = (block.filled | block.below) & cells_in_range(at, level.cells_of(box)); cells;
       cells &= cells - 1) {
    const int cell = std::countr_zero(cells);
    const std::int64_t place[3]{at[0] * side + (cell & 3), at[1] * side + (cell >> 2 & 3), at[2] * side + (cell >> 4)};
    if (plane) {
      const Vec3 middle = level.cell * Vec3(static_cast<double>(place[0]) + 0.5, static_cast<double>(place[1]) + 0.5,
                                            static_cast<double>(place[2]) + 0.5);
      if (plane->clear_of(middle, Vec3::Constant(0.5 * level.cell))) continue;
    }
    if (block.filled >> cell & 1) {
      const Part wanted = level.part_of(box, place);
      for (auto b = block.first[cell]; b != none; b = bunches_[b].next) {
        const Bunch& bunch = bunches_[b];
        for (int i = 0; i < Bunch::size && bunch.id[i] != none; ++i)
          if (bunch.part[i].meets(wanted)) take(bunch.id[i]);
      }
    }
    if (block.below >> cell & 1) visit(at_level - 1, place, box, plane, take);
  }
}

// From the coarsest level down. Each is appended once, in ascending order.
template <class Take>
void TriangleIndex::search(const Box3& box, const Plane* plane, const Take& take,
                           std::vector<std::uint32_t>& out) const {
  if (levels_.empty()) return;
  const std::size_t first = out.size(), top = levels_.size() - 1;
  const Level& level = levels_[top];
  const Range blocks = level.cells_of(box).shifted(block_shift);
  const auto look = [&](const std::int64_t(&at)[3]) { visit(top, at, box, plane, take); };
  // Blocks that a plane passes through are about two to a column.
  const double columns = plane ? double(blocks.hi[plane->axis()] - blocks.lo[plane->axis()] + 1) : 1;
  if (blocks.count() > columns * static_cast<double>(level.slots.size())) {
    for (const Slot& slot : level.slots)
      if (slot.block != none) look(slot.at);
  } else if (plane) {
    plane->each_cube(blocks, side * level.cell, look);
  } else {
    each_place(blocks, look);
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
  if (!plane.known()) return find(box, out);
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
