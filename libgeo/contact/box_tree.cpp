// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is taken at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/box_tree.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "contact/box_tree.h"

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// Which of a block's boxes meet one box of another block.
HWY_INLINE std::uint32_t meeting(const BoxTree::Block& boxes, const BoxTree::Block& other, std::uint32_t lane) {
  const hn::CappedTag<float, BoxTree::width> d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < BoxTree::width; at += hn::Lanes(d)) {
    auto mask = hn::Le(hn::Load(d, boxes.lo[0] + at), hn::Set(d, other.hi[0][lane]));
    mask = hn::And(mask, hn::Ge(hn::Load(d, boxes.hi[0] + at), hn::Set(d, other.lo[0][lane])));
    for (int axis = 1; axis < 3; ++axis) {
      mask = hn::And(mask, hn::Le(hn::Load(d, boxes.lo[axis] + at), hn::Set(d, other.hi[axis][lane])));
      mask = hn::And(mask, hn::Ge(hn::Load(d, boxes.hi[axis] + at), hn::Set(d, other.lo[axis][lane])));
    }
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    bits |= (bytes[0] | std::uint32_t(bytes[1]) << 8) << at;
  }
  return bits;
}

// Which triangles of a block have a corner in common with one of another block.
HWY_INLINE std::uint32_t sharing(const BoxTree::Corners& block, const BoxTree::Corners& other, std::uint32_t lane) {
  const hn::CappedTag<std::uint32_t, BoxTree::width> d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < BoxTree::width; at += hn::Lanes(d)) {
    const auto a = hn::Load(d, block.v[0] + at), b = hn::Load(d, block.v[1] + at), c = hn::Load(d, block.v[2] + at);
    const auto in_any = [&](int k) HWY_ATTR {
      const auto corner = hn::Set(d, other.v[k][lane]);
      return hn::Or(hn::Eq(a, corner), hn::Or(hn::Eq(b, corner), hn::Eq(c, corner)));
    };
    const auto mask = hn::Or(in_any(0), hn::Or(in_any(1), in_any(2)));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    bits |= (bytes[0] | std::uint32_t(bytes[1]) << 8) << at;
  }
  return bits;
}

// Blocks of the lowest level that meet the box around block `own` of it, from block `first` on.
void blocks_near(const std::vector<std::vector<BoxTree::Block>>& levels, std::uint32_t own, std::uint32_t first, std::vector<std::uint32_t>& out) {
  constexpr std::uint32_t width = BoxTree::width;
  out.clear();
  struct Place {
    std::uint32_t level, block;
  };
  Place stack[8 * width];  // 2³² boxes have eight levels
  int top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  while (top > 0) {
    const auto [level, block] = stack[--top];
    if (level == 0) {
      out.push_back(block);
      continue;
    }
    auto lanes = meeting(levels[level][block], levels[1][own / width], own % width);
    const std::uint32_t least = first >> std::countr_zero(width) * (level - 1);  // what comes before it ends before `first`
    if (least > block * width) lanes &= ~0u << (least - block * width);
    for (; lanes != 0; lanes &= lanes - 1) stack[top++] = {level - 1, block * width + static_cast<std::uint32_t>(std::countr_zero(lanes))};
  }
}

}  // namespace

// Pairs of places in the tree, of one block with all: with places behind each, or with all but those behind it that are marked. None
// with a corner in common, where these are given (null: not).
void pairs_of_block(const std::vector<std::vector<BoxTree::Block>>& levels, const BoxTree::Corners* corners, std::uint32_t own, std::uint32_t asked, const std::uint8_t* marked,
                    std::vector<std::uint32_t>& near, std::vector<std::pair<std::uint32_t, std::uint32_t>>& out) {
  constexpr std::uint32_t width = BoxTree::width;
  blocks_near(levels, own, marked ? 0 : own, near);
  for (const auto block : near)
    for (auto lanes = asked & meeting(levels[0][own], levels[1][block / width], block % width); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes)), place = own * width + lane;
      auto met = meeting(levels[0][block], levels[0][own], lane);
      if (block == own && !marked) met &= ~((2u << lane) - 1);
      if (corners) met &= ~sharing(corners[block], corners[own], lane);
      for (; met != 0; met &= met - 1)
        if (const auto other = block * width + static_cast<std::uint32_t>(std::countr_zero(met)); !marked || !(marked[other] && other <= place)) out.push_back({place, other});
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(pairs_of_block);
namespace {

// A float that is not above x, by some steps of the last place; without branches. What is beyond all floats goes to the last of them, never to infinity, where
// places without a box have their ends.
float below(double x) {
  constexpr float last = std::numeric_limits<float>::max();
  const auto f = static_cast<float>(std::clamp<double>(x, -last, last));
  return std::max(f - (std::abs(f) * 0x1p-22f + std::numeric_limits<float>::min()), -last);
}
float above(double x) { return -below(-x); }

// Every third bit of the result is one of x, of ten.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff, x = (x | x << 8) & 0x0300f00f, x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

using Places = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // on the curve, and rows

// By place; those at the same one stay in their order.
void sort_along(Places& places) {
  constexpr std::uint32_t bits = 10, buckets = 1u << bits;
  Places sorted(places.size());
  for (std::uint32_t shift = 0; shift < 30; shift += bits) {
    std::array<std::uint32_t, buckets + 1> first{};
    for (const auto& [place, row] : places) ++first[(place >> shift) % buckets + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (const auto& one : places) sorted[first[(one.first >> shift) % buckets]++] = one;
    places.swap(sorted);
  }
}

std::vector<BoxTree::Block> empty_blocks(std::size_t boxes) {
  BoxTree::Block none;
  for (int axis = 0; axis < 3; ++axis) std::fill_n(none.lo[axis], BoxTree::width, INFINITY), std::fill_n(none.hi[axis], BoxTree::width, -INFINITY);
  return std::vector<BoxTree::Block>((boxes + BoxTree::width - 1) / BoxTree::width, none);
}

// True when that changed it.
bool add(BoxTree::Block& block, std::size_t lane, const float* lo, const float* hi) {
  bool larger = false;
  for (int axis = 0; axis < 3; ++axis) {
    float &least = block.lo[axis][lane], &most = block.hi[axis][lane];
    larger |= lo[axis] < least || hi[axis] > most;
    least = std::min(least, lo[axis]), most = std::max(most, hi[axis]);
  }
  return larger;
}

}  // namespace

BoxTree::BoxTree(std::vector<Box3> boxes, std::span<const Triangle> triangles) : boxes_(std::move(boxes)), place_(boxes_.size(), ~0u) {
  const Box3 all = bound();
  if (all.empty()) return;
  Places along;
  along.reserve(boxes_.size());
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
    if (!boxes_[i].empty()) along.push_back({0, i});
  const Vec3 scale = 1023 * (all.hi - all.lo).cwiseMax(1e-300).cwiseInverse();
  parallel_for(along.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Box3& box = boxes_[along[k].second];
      const Vec3 at = (0.5 * box.lo + 0.5 * box.hi - all.lo).cwiseProduct(scale);
      along[k].first = spread(static_cast<std::uint32_t>(at[0])) << 2 | spread(static_cast<std::uint32_t>(at[1])) << 1 | spread(static_cast<std::uint32_t>(at[2]));
    }
  });
  sort_along(along);
  order_.resize(along.size());
  if (!triangles.empty()) corners_.resize((along.size() + width - 1) / width);
  parallel_for(along.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = along[i].second;
      order_[i] = row, place_[row] = static_cast<std::uint32_t>(i);
      for (std::size_t k = 0; k < 3 && !triangles.empty(); ++k) corners_[i / width].v[k][i % width] = triangles[row][k];
    }
  });
  fill();
  made_ = block_sizes();
}

bool BoxTree::replace(std::vector<Box3>& boxes) {
  if (boxes.size() != boxes_.size()) return false;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (place_[i] == ~0u && !boxes[i].empty()) return false;
  boxes_ = std::move(boxes);
  bound();
  if (!order_.empty()) fill();
  return true;
}

// Of all boxes; floats are about its middle from now on.
Box3 BoxTree::bound() {
  Box3 all;
  for (const Box3& b : boxes_)
    if (!b.empty()) all.add(b);
  if (!all.empty()) middle_ = 0.5 * all.lo + 0.5 * all.hi;
  return all;
}

void BoxTree::fill() {
  levels_.assign(1, empty_blocks(order_.size()));
  parallel_for(order_.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (boxes_[order_[i]].empty()) continue;
      const Floats b = local(boxes_[order_[i]]);
      Block& block = levels_[0][i / width];
      for (int axis = 0; axis < 3; ++axis) block.lo[axis][i % width] = b.lo[axis], block.hi[axis][i % width] = b.hi[axis];
    }
  });
  while (levels_.size() < 2 || levels_.back().size() > 1) {
    const auto& lower = levels_.back();
    auto level = empty_blocks(lower.size());
    parallel_for(lower.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          float lo = INFINITY, hi = -INFINITY;
          for (std::uint32_t k = 0; k < width; ++k) lo = std::min(lo, lower[i].lo[axis][k]), hi = std::max(hi, lower[i].hi[axis][k]);
          level[i / width].lo[axis][i % width] = lo, level[i / width].hi[axis][i % width] = hi;
        }
    });
    levels_.push_back(std::move(level));
  }
}

void BoxTree::put(std::vector<Box3> boxes, std::span<const Triangle> triangles) {
  constexpr double worn = 1.2;
  if (!replace(boxes)) *this = BoxTree(std::move(boxes), triangles);
  else if (block_sizes() > worn * made_) *this = BoxTree(std::move(boxes_), triangles);
}

double BoxTree::block_sizes() const {
  if (levels_.empty()) return 0;
  double sum = 0;
  for (const Block& b : levels_[1])
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t k = 0; k < width; ++k)
        if (b.lo[axis][k] <= b.hi[axis][k]) sum += double(b.hi[axis][k]) - double(b.lo[axis][k]);
  return sum;
}

BoxTree::Floats BoxTree::local(const Box3& box) const {
  Floats b;
  for (int axis = 0; axis < 3; ++axis) b.lo[axis] = below(box.lo[axis] - middle_[axis]), b.hi[axis] = above(box.hi[axis] - middle_[axis]);
  return b;
}

void BoxTree::enlarge(std::uint32_t row, const Box3& box) {
  boxes_[row].add(box);
  const Floats b = local(box);
  std::uint32_t place = place_[row];
  for (auto& level : levels_) {
    if (!add(level[place / width], place % width, b.lo, b.hi)) break;
    place /= width;
  }
}

BoxTree::Pairs BoxTree::pairs(const std::vector<std::uint8_t>* only, const std::function<void(Pairs&)>& narrow) const {
  if (levels_.empty()) return {};
  std::vector<std::uint8_t> marked;
  if (only) {
    marked.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) marked[i] = (*only)[order_[i]];
  }
  constexpr std::size_t stretch = 16;  // blocks
  const std::size_t blocks = levels_[0].size();
  std::vector<Pairs> found((blocks + stretch - 1) / stretch);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    Pairs some;
    for (std::size_t s = begin; s < end; ++s) {
      some.clear();
      for (std::size_t b = s * stretch; b < std::min(blocks, (s + 1) * stretch); ++b) {
        std::uint32_t asked = 0;
        for (std::size_t i = b * width; i < std::min(order_.size(), (b + 1) * width); ++i) asked |= std::uint32_t(!only || marked[i]) << i % width;
        if (asked != 0) HWY_DYNAMIC_DISPATCH(pairs_of_block)(levels_, corners_.empty() ? nullptr : corners_.data(), static_cast<std::uint32_t>(b), asked, only ? marked.data() : nullptr, near, some);
      }
      std::size_t count = 0;
      for (const auto& [p, q] : some)
        if (const auto i = order_[p], j = order_[q]; boxes_[i].meets(boxes_[j])) some[count++] = {std::min(i, j), std::max(i, j)};
      some.resize(count);
      if (narrow) narrow(some);
      found[s].assign(some.begin(), some.end());
    }
  });
  std::vector<std::size_t> first(found.size() + 1, 0);
  for (std::size_t s = 0; s < found.size(); ++s) first[s + 1] = first[s] + found[s].size();
  Pairs result(first.back());
  parallel_for(found.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) std::copy(found[s].begin(), found[s].end(), result.begin() + static_cast<std::ptrdiff_t>(first[s]));
  });
  return result;
}

}  // namespace geo
#endif
