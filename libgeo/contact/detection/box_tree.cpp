// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is taken at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/box_tree.cpp"
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)  // vectors that no array can hold
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "contact/detection/box_tree.h"
#include "kerf/parallel.h"

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

}  // namespace

// Blocks of the lowest level in the order of `rows`, of which the last one may not be full, and the boxes around them
// in the level above. What is beyond all floats goes to the last of them, never to infinity, where places without a box
// have their ends.
void fill_blocks(const Box3* boxes, std::span<const std::uint32_t> rows, const Vec3& middle, std::size_t begin,
                 std::size_t end, std::vector<std::vector<BoxTree::Block>>& levels) {
  static_assert(sizeof(Box3) == 6 * sizeof(double) && offsetof(Box3, hi) == 3 * sizeof(double));
  constexpr std::size_t width = BoxTree::width;
  const hn::CappedTag<double, width / 2> d;
  const hn::Rebind<float, decltype(d)> f;
  const hn::Rebind<std::int64_t, decltype(d)> number;
  const auto last = hn::Set(d, std::numeric_limits<float>::max());
  for (std::size_t b = begin; b < end; ++b) {
    BoxTree::Block& block = levels[0][b];
    const std::size_t count = std::min(width, rows.size() - b * width);
    alignas(64) std::int64_t first[width];
    for (std::size_t k = 0; k < width; ++k) first[k] = 6 * std::int64_t(rows[b * width + std::min(k, count - 1)]);
    for (std::size_t at = 0; at < width; at += hn::Lanes(d)) {
      hn::Vec<decltype(d)> lo[3], hi[3];
      auto full = hn::FirstN(d, count - std::min(count, at));
      for (int axis = 0; axis < 3; ++axis) {
        const auto from = hn::Load(number, first + at);
        lo[axis] = hn::GatherIndex(d, boxes->lo.data() + axis, from),
        hi[axis] = hn::GatherIndex(d, boxes->hi.data() + axis, from);
        full = hn::And(full, hn::Le(lo[axis], hi[axis]));
      }
      for (int axis = 0; axis < 3; ++axis) {
        const auto origin = hn::Set(d, middle[axis]);
        const auto low = hn::Min(hn::Max(hn::Sub(lo[axis], origin), hn::Neg(last)), last),
                   high = hn::Min(hn::Max(hn::Sub(hi[axis], origin), hn::Neg(last)), last);
        hn::Store(hn::DemoteTo(f, low), f, block.lo[axis] + at),
            hn::Store(hn::DemoteTo(f, high), f, block.hi[axis] + at);
      }
      if (hn::AllTrue(d, full)) continue;
      alignas(64) double there[width];
      hn::Store(hn::IfThenElseZero(full, last), d, there);
      for (std::size_t k = 0; k < hn::Lanes(d); ++k)
        for (int axis = 0; axis < 3 && there[k] == 0; ++axis)
          block.lo[axis][at + k] = INFINITY, block.hi[axis][at + k] = -INFINITY;
    }
    const hn::CappedTag<float, BoxTree::width> all;
    for (int axis = 0; axis < 3; ++axis) {
      auto lo = hn::Load(all, block.lo[axis]), hi = hn::Load(all, block.hi[axis]);
      for (std::size_t at = hn::Lanes(all); at < width; at += hn::Lanes(all))
        lo = hn::Min(lo, hn::Load(all, block.lo[axis] + at)), hi = hn::Max(hi, hn::Load(all, block.hi[axis] + at));
      levels[1][b / width].lo[axis][b % width] = hn::GetLane(hn::MinOfLanes(all, lo)),
                                        levels[1][b / width].hi[axis][b % width] = hn::GetLane(hn::MaxOfLanes(all, hi));
    }
  }
}

// Where cells are on a Hilbert curve of ten bits an axis (Skilling 2004), into the first of their numbers.
void follow_curve(BoxTree::Cells& cells) {
  const hn::CappedTag<std::uint32_t, BoxTree::width> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::uint32_t highest = 1u << 9;
  // Every third bit of the result is one of v.
  const auto spread = [&](V v) HWY_ATTR {
    v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x030000ff)),
    v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x0300f00f));
    v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x030c30c3));
    return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x09249249));
  };
  for (std::size_t at = 0; at < BoxTree::width; at += hn::Lanes(d)) {
    V x[3] = {hn::Load(d, cells.at[0] + at), hn::Load(d, cells.at[1] + at), hn::Load(d, cells.at[2] + at)};
    for (std::uint32_t bit = highest; bit > 1; bit /= 2) {
      const auto lower = hn::Set(d, bit - 1);
      for (V& one : x) {  // the lower bits of the first are turned, or change places
        const auto turned = hn::TestBit(one, hn::Set(d, bit));
        const auto swapped = hn::IfThenZeroElse(turned, hn::And(hn::Xor(x[0], one), lower));
        one = hn::Xor(one, swapped);
        x[0] = hn::Xor(x[0], hn::IfThenElse(turned, lower, swapped));
      }
    }
    x[1] = hn::Xor(x[1], x[0]), x[2] = hn::Xor(x[2], x[1]);
    auto turn = hn::Zero(d);
    for (std::uint32_t bit = highest; bit > 1; bit /= 2)
      turn = hn::Xor(turn, hn::IfThenElseZero(hn::TestBit(x[2], hn::Set(d, bit)), hn::Set(d, bit - 1)));
    for (V& one : x) one = hn::Xor(one, turn);
    hn::Store(hn::Or(hn::ShiftLeft<2>(spread(x[0])), hn::Or(hn::ShiftLeft<1>(spread(x[1])), spread(x[2]))), d,
              cells.at[0] + at);
  }
}

// Blocks of level 1 that meet the box around block `own` of it, from block `first` on.
void blocks_near(const std::vector<std::vector<BoxTree::Block>>& levels, std::uint32_t own, std::uint32_t first,
                 std::vector<std::uint32_t>& out) {
  constexpr std::uint32_t width = BoxTree::width;
  out.assign(levels.size() == 2 ? 1 : 0, 0);  // the only one
  if (levels.size() == 2) return;
  struct Place {
    std::uint32_t level, block;
  };
  Place stack[8 * width];  // 2³² boxes have eight levels
  int top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  while (top > 0) {
    const auto [level, block] = stack[--top];
    if (level == 1) {
      out.push_back(block);
      continue;
    }
    auto lanes = meeting(levels[level][block], levels[2][own / width], own % width);
    const std::uint32_t least =
        first >> std::countr_zero(width) * (level - 2);  // what comes before it ends before `first`
    if (least > block * width) lanes &= ~0u << (least - block * width);
    for (; lanes != 0; lanes &= lanes - 1)
      stack[top++] = {level - 1, block * width + static_cast<std::uint32_t>(std::countr_zero(lanes))};
  }
}

// Pairs of places in the tree, of one block with all: with places behind each, or with all but those behind it that are
// marked. None with a corner in common, where these are given (null: not). `near`: blocks of level 1 as blocks_near()
// has them of the one around it.
void pairs_of_block(const std::vector<std::vector<BoxTree::Block>>& levels, const BoxTree::Corners* corners,
                    std::uint32_t own, std::uint32_t asked, const std::uint8_t* marked,
                    std::span<const std::uint32_t> near, std::vector<std::pair<std::uint32_t, std::uint32_t>>& out) {
  constexpr std::uint32_t width = BoxTree::width;
  const BoxTree::Block &mine = levels[0][own], &around = levels[1][own / width];
  const auto pairs_with = [&, boxes = levels[0].data(), corners](std::uint32_t block, std::uint32_t lanes) HWY_ATTR {
    for (lanes &= asked; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes)), place = own * width + lane;
      auto met = meeting(boxes[block], mine, lane);
      if (block == own && !marked) met &= ~((2u << lane) - 1);
      if (corners && met != 0) met &= ~sharing(corners[block], corners[own], lane);
      for (; met != 0; met &= met - 1)
        if (const auto other = block * width + static_cast<std::uint32_t>(std::countr_zero(met));
            !marked || !(marked[other] && other <= place))
          out.push_back({place, other});
    }
  };
  for (const auto above : near) {
    const BoxTree::Block& blocks = levels[1][above];
    auto met = meeting(blocks, around, own % width);
    if (above == own / width && !marked) met &= ~0u << own % width;
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      pairs_with(above * width + lane, meeting(mine, blocks, lane));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(fill_blocks);
HWY_EXPORT(follow_curve);
HWY_EXPORT(blocks_near);
HWY_EXPORT(pairs_of_block);
namespace {

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
  for (int axis = 0; axis < 3; ++axis)
    std::fill_n(none.lo[axis], BoxTree::width, INFINITY), std::fill_n(none.hi[axis], BoxTree::width, -INFINITY);
  return std::vector<BoxTree::Block>((boxes + BoxTree::width - 1) / BoxTree::width, none);
}

// Makes a box of a block larger, so that it holds one of another. True when that changed it.
bool add(BoxTree::Block& block, std::uint32_t lane, const BoxTree::Block& other, std::uint32_t other_lane) {
  bool larger = false;
  for (int axis = 0; axis < 3; ++axis) {
    float &least = block.lo[axis][lane], &most = block.hi[axis][lane];
    const float lo = other.lo[axis][other_lane], hi = other.hi[axis][other_lane];
    larger |= lo < least || hi > most;
    least = std::min(least, lo), most = std::max(most, hi);
  }
  return larger;
}

}  // namespace

BoxTree::BoxTree(std::vector<Box3> boxes, std::span<const Triangle> triangles)
    : boxes_(std::move(boxes)), place_(boxes_.size(), ~0u) {
  Box3 all;
  Places along;
  along.reserve(boxes_.size());
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
    if (!boxes_[i].empty()) all.add(boxes_[i]), along.push_back({0, i});
  if (along.empty()) return;
  middle_ = 0.5 * all.lo + 0.5 * all.hi;
  const double scale = 1023 / std::max((all.hi - all.lo).maxCoeff(), 1e-300);
  parallel_for((along.size() + width - 1) / width, 64, [&](std::size_t begin, std::size_t end) {
    Cells cells{};
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t first = b * width, count = std::min<std::size_t>(width, along.size() - first);
      for (std::size_t k = 0; k < count; ++k) {
        const Box3& box = boxes_[along[first + k].second];
        for (int axis = 0; axis < 3; ++axis)
          cells.at[axis][k] =
              static_cast<std::uint32_t>((0.5 * box.lo[axis] + 0.5 * box.hi[axis] - all.lo[axis]) * scale);
      }
      HWY_DYNAMIC_DISPATCH(follow_curve)(cells);
      for (std::size_t k = 0; k < count; ++k) along[first + k].first = cells.at[0][k];
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
  for (std::size_t size = order_.size(); levels_.size() < 2 || size > 1; size = levels_.back().size())
    levels_.push_back(empty_blocks(size));
  fill();
  made_ = block_sizes();
}

bool BoxTree::replace(std::vector<Box3>& boxes) {
  if (boxes.size() != boxes_.size()) return false;
  for (std::size_t i = 0; i < boxes.size() && order_.size() < boxes.size(); ++i)
    if (place_[i] == ~0u && !boxes[i].empty()) return false;
  boxes_ = std::move(boxes);
  if (!order_.empty()) fill();
  return true;
}

void BoxTree::fill() {
  parallel_for(levels_[0].size(), 64, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(fill_blocks)(boxes_.data(), order_, middle_, begin, end, levels_);
  });
  for (std::size_t l = 1; l + 1 < levels_.size(); ++l)
    for (std::size_t i = 0; i < levels_[l].size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const Block& lower = levels_[l][i];
        levels_[l + 1][i / width].lo[axis][i % width] = *std::min_element(lower.lo[axis], lower.lo[axis] + width);
        levels_[l + 1][i / width].hi[axis][i % width] = *std::max_element(lower.hi[axis], lower.hi[axis] + width);
      }
}

void BoxTree::put(std::vector<Box3> boxes, std::span<const Triangle> triangles) {
  constexpr double worn = 1.2,
                   flat = 0.2;  // so flat is what has gone so far that floats no longer tell its boxes apart
  if (!replace(boxes))
    *this = BoxTree(std::move(boxes), triangles);
  else if (const double size = block_sizes(); size > worn * made_ || size < flat * made_)
    *this = BoxTree(std::move(boxes_), triangles);
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

void BoxTree::enlarge(std::uint32_t row, const Box3& box) {
  boxes_[row].add(box);
  std::uint32_t place = place_[row] / width;
  HWY_DYNAMIC_DISPATCH(fill_blocks)(boxes_.data(), order_, middle_, place, place + 1, levels_);
  for (std::size_t l = 1; l + 1 < levels_.size() && add(levels_[l + 1][place / width / width], place / width % width,
                                                        levels_[l][place / width], place % width);
       ++l)
    place /= width;
}

BoxTree::Pairs BoxTree::pairs(const std::vector<std::uint8_t>* only, const std::function<void(Pairs&)>& narrow) const {
  if (levels_.empty()) return {};
  std::vector<std::uint8_t> marked;
  if (only) {
    marked.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) marked[i] = (*only)[order_[i]];
  }
  std::vector<Pairs> found(levels_[1].size());  // of boxes in each block of blocks
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    Pairs some;
    for (std::size_t s = begin; s < end; ++s) {
      some.clear();
      std::uint32_t asked[width] = {}, any = 0;  // of each block
      for (std::size_t i = s * width * width; i < std::min(order_.size(), (s + 1) * width * width); ++i) {
        const auto bit = std::uint32_t(!only || marked[i]) << i % width;
        asked[i / width % width] |= bit, any |= bit;
      }
      if (any == 0) continue;
      const auto own = static_cast<std::uint32_t>(s);
      HWY_DYNAMIC_DISPATCH(blocks_near)(levels_, own, only ? 0 : own, near);
      for (std::uint32_t b = 0; b < width; ++b)
        if (asked[b] != 0)
          HWY_DYNAMIC_DISPATCH(pairs_of_block)
          (levels_, corners_.empty() ? nullptr : corners_.data(), own * width + b, asked[b],
           only ? marked.data() : nullptr, near, some);
      std::size_t count = 0;
      for (const auto& [p, q] : some)
        if (const auto i = order_[p], j = order_[q]; boxes_[i].meets(boxes_[j]))
          some[count++] = {std::min(i, j), std::max(i, j)};
      some.resize(count);
      if (narrow) narrow(some);
      found[s].assign(some.begin(), some.end());
    }
  });
  std::vector<std::size_t> first(found.size() + 1, 0);
  for (std::size_t s = 0; s < found.size(); ++s) first[s + 1] = first[s] + found[s].size();
  Pairs result(first.back());
  parallel_for(found.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      std::copy(found[s].begin(), found[s].end(), result.begin() + static_cast<std::ptrdiff_t>(first[s]));
  });
  return result;
}

}  // namespace geo
#endif
