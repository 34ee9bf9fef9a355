// Boxes sorted along a Hilbert curve and packed bottom-up into groups of 16, as in a Hilbert R-tree
// (Kamel and Faloutsos 1993). Queries descend from the root once for each 256 neighbouring boxes.
// Compiled for each instruction set (base/simd_targets.h).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/aabb_tree.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "geometry/aabb_tree.h"
#include "kerf/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// The lanes of the boxes of a group that meet one box of another group.
HWY_INLINE std::uint32_t meeting(const AabbTree::BoxGroup& boxes, const AabbTree::BoxGroup& other, std::uint32_t lane) {
  const hn::CappedTag<float, AabbTree::width> d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < AabbTree::width; at += hn::Lanes(d)) {
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

// The lanes of the triangles of a group that share a vertex with one triangle of another group.
HWY_INLINE std::uint32_t sharing(const AabbTree::Corners& group, const AabbTree::Corners& other, std::uint32_t lane) {
  const hn::CappedTag<std::uint32_t, AabbTree::width> d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < AabbTree::width; at += hn::Lanes(d)) {
    const auto a = hn::Load(d, group.v[0] + at), b = hn::Load(d, group.v[1] + at), c = hn::Load(d, group.v[2] + at);
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

// Fills groups [begin, end) of the lowest level with boxes in the given order, and the boxes
// around these groups in the level above. Coordinates beyond the range of floats become the
// largest float, never infinity, which marks unused lanes. The last group may be partly unused.
void fill_groups(const Box3* boxes, std::span<const std::uint32_t> order, const Vec3& middle, std::size_t begin,
                 std::size_t end, std::vector<std::vector<AabbTree::BoxGroup>>& levels) {
  static_assert(sizeof(Box3) == 6 * sizeof(double) && offsetof(Box3, hi) == 3 * sizeof(double));
  constexpr std::size_t width = AabbTree::width;
  const hn::CappedTag<double, width / 2> d;
  const hn::Rebind<float, decltype(d)> f;
  const hn::Rebind<std::int64_t, decltype(d)> number;
  const auto largest = hn::Set(d, std::numeric_limits<float>::max());
  for (std::size_t b = begin; b < end; ++b) {
    AabbTree::BoxGroup& group = levels[0][b];
    const std::size_t count = std::min(width, order.size() - b * width);
    alignas(64) std::int64_t first[width];
    for (std::size_t k = 0; k < width; ++k) first[k] = 6 * std::int64_t(order[b * width + std::min(k, count - 1)]);
    for (std::size_t at = 0; at < width; at += hn::Lanes(d)) {
      hn::Vec<decltype(d)> lo[3], hi[3];
      auto full = hn::FirstN(d, count - std::min(count, at));
      for (int axis = 0; axis < 3; ++axis) {
        const auto from = hn::Load(number, first + at);
        lo[axis] = hn::GatherIndex(d, boxes->lo.data() + axis, from);
        hi[axis] = hn::GatherIndex(d, boxes->hi.data() + axis, from);
        full = hn::And(full, hn::Le(lo[axis], hi[axis]));
      }
      for (int axis = 0; axis < 3; ++axis) {
        const auto origin = hn::Set(d, middle[axis]);
        const auto low = hn::Min(hn::Max(hn::Sub(lo[axis], origin), hn::Neg(largest)), largest),
                   high = hn::Min(hn::Max(hn::Sub(hi[axis], origin), hn::Neg(largest)), largest);
        hn::Store(hn::DemoteTo(f, low), f, group.lo[axis] + at);
        hn::Store(hn::DemoteTo(f, high), f, group.hi[axis] + at);
      }
      if (hn::AllTrue(d, full)) continue;
      alignas(64) double used[width];
      hn::Store(hn::IfThenElseZero(full, largest), d, used);
      for (std::size_t k = 0; k < hn::Lanes(d); ++k)
        for (int axis = 0; axis < 3 && used[k] == 0; ++axis) {
          group.lo[axis][at + k] = INFINITY;
          group.hi[axis][at + k] = -INFINITY;
        }
    }
    const hn::CappedTag<float, AabbTree::width> all;
    for (int axis = 0; axis < 3; ++axis) {
      auto lo = hn::Load(all, group.lo[axis]), hi = hn::Load(all, group.hi[axis]);
      for (std::size_t at = hn::Lanes(all); at < width; at += hn::Lanes(all)) {
        lo = hn::Min(lo, hn::Load(all, group.lo[axis] + at));
        hi = hn::Max(hi, hn::Load(all, group.hi[axis] + at));
      }
      levels[1][b / width].lo[axis][b % width] = hn::GetLane(hn::MinOfLanes(all, lo));
      levels[1][b / width].hi[axis][b % width] = hn::GetLane(hn::MaxOfLanes(all, hi));
    }
  }
}

// Positions of cells on the Hilbert curve with ten bits an axis (Skilling 2004), written to
// cells.at[0].
void hilbert_positions(AabbTree::Cells& cells) {
  const hn::CappedTag<std::uint32_t, AabbTree::width> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::uint32_t highest = 1u << 9;
  // Spreads the bits of v to every third bit of the result.
  const auto spread = [&](V v) HWY_ATTR {
    v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x030000ff)),
    v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x0300f00f));
    v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x030c30c3));
    return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x09249249));
  };
  for (std::size_t at = 0; at < AabbTree::width; at += hn::Lanes(d)) {
    V x[3] = {hn::Load(d, cells.at[0] + at), hn::Load(d, cells.at[1] + at), hn::Load(d, cells.at[2] + at)};
    for (std::uint32_t bit = highest; bit > 1; bit /= 2) {
      const auto lower = hn::Set(d, bit - 1);
      for (V& one : x) {  // inverts the lower bits of x[0], or exchanges them with those of `one`
        const auto inverted = hn::TestBit(one, hn::Set(d, bit));
        const auto swapped = hn::IfThenZeroElse(inverted, hn::And(hn::Xor(x[0], one), lower));
        one = hn::Xor(one, swapped);
        x[0] = hn::Xor(x[0], hn::IfThenElse(inverted, lower, swapped));
      }
    }
    x[1] = hn::Xor(x[1], x[0]);
    x[2] = hn::Xor(x[2], x[1]);
    auto gray = hn::Zero(d);  // the Gray code's last step
    for (std::uint32_t bit = highest; bit > 1; bit /= 2)
      gray = hn::Xor(gray, hn::IfThenElseZero(hn::TestBit(x[2], hn::Set(d, bit)), hn::Set(d, bit - 1)));
    for (V& one : x) one = hn::Xor(one, gray);
    hn::Store(hn::Or(hn::ShiftLeft<2>(spread(x[0])), hn::Or(hn::ShiftLeft<1>(spread(x[1])), spread(x[2]))), d,
              cells.at[0] + at);
  }
}

// The groups of level 1, from group `first` on, that meet the box around group `own` of that level.
void overlapping_groups(const std::vector<std::vector<AabbTree::BoxGroup>>& levels, std::uint32_t own,
                        std::uint32_t first, std::vector<std::uint32_t>& out) {
  constexpr std::uint32_t width = AabbTree::width;
  out.assign(levels.size() == 2 ? 1 : 0, 0);  // two levels: there is one group
  if (levels.size() == 2) return;
  struct Entry {
    std::uint32_t level, group;
  };
  Entry stack[8 * width];  // 2³² boxes have eight levels
  int top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  while (top > 0) {
    const auto [level, group] = stack[--top];
    if (level == 1) {
      out.push_back(group);
      continue;
    }
    auto lanes = meeting(levels[level][group], levels[2][own / width], own % width);
    // Descendants of earlier groups come before `first`.
    const std::uint32_t earliest = first >> std::countr_zero(width) * (level - 2);
    if (earliest > group * width) lanes &= ~0u << (earliest - group * width);
    for (; lanes != 0; lanes &= lanes - 1)
      stack[top++] = {level - 1, group * width + static_cast<std::uint32_t>(std::countr_zero(lanes))};
  }
}

// Appends pairs of places (lane positions in the tree) for the boxes of group `own` in the lanes
// `queried`. Without `marked`, pairs with later places; with it, with all places except marked
// ones that are not later, since these report the pair themselves. Pairs of triangles with a
// common vertex are left out if `corners` is not null. `near`: overlapping_groups() of the group
// around `own`.
void pairs_of_group(const std::vector<std::vector<AabbTree::BoxGroup>>& levels, const AabbTree::Corners* corners,
                    std::uint32_t own, std::uint32_t queried, const std::uint8_t* marked,
                    std::span<const std::uint32_t> near, std::vector<std::pair<std::uint32_t, std::uint32_t>>& out) {
  constexpr std::uint32_t width = AabbTree::width;
  const AabbTree::BoxGroup &mine = levels[0][own], &around = levels[1][own / width];
  const auto pairs_with = [&, boxes = levels[0].data(), corners](std::uint32_t group, std::uint32_t lanes) HWY_ATTR {
    for (lanes &= queried; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes)), place = own * width + lane;
      auto met = meeting(boxes[group], mine, lane);
      if (group == own && !marked) met &= ~((2u << lane) - 1);
      if (corners && met != 0) met &= ~sharing(corners[group], corners[own], lane);
      for (; met != 0; met &= met - 1)
        if (const auto other = group * width + static_cast<std::uint32_t>(std::countr_zero(met));
            !marked || !(marked[other] && other <= place))
          out.push_back({place, other});
    }
  };
  for (const auto above : near) {
    const AabbTree::BoxGroup& groups = levels[1][above];
    auto met = meeting(groups, around, own % width);
    if (above == own / width && !marked) met &= ~0u << own % width;
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      pairs_with(above * width + lane, meeting(mine, groups, lane));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(fill_groups);
HWY_EXPORT(hilbert_positions);
HWY_EXPORT(overlapping_groups);
HWY_EXPORT(pairs_of_group);
namespace {

using CurveOrder = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // position on the curve, index of the box

// A stable radix sort by position.
void sort_by_position(CurveOrder& boxes) {
  constexpr std::uint32_t bits = 10, buckets = 1u << bits;
  CurveOrder sorted(boxes.size());
  for (std::uint32_t shift = 0; shift < 30; shift += bits) {
    std::array<std::uint32_t, buckets + 1> first{};
    for (const auto& [position, index] : boxes) ++first[(position >> shift) % buckets + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (const auto& one : boxes) sorted[first[(one.first >> shift) % buckets]++] = one;
    boxes.swap(sorted);
  }
}

// Groups of empty boxes, enough for this number.
std::vector<AabbTree::BoxGroup> empty_groups(std::size_t boxes) {
  AabbTree::BoxGroup none;
  for (int axis = 0; axis < 3; ++axis) {
    std::fill_n(none.lo[axis], AabbTree::width, INFINITY);
    std::fill_n(none.hi[axis], AabbTree::width, -INFINITY);
  }
  return std::vector<AabbTree::BoxGroup>((boxes + AabbTree::width - 1) / AabbTree::width, none);
}

// Extends one box of a group to contain one of another. Returns whether that changed it.
bool extend(AabbTree::BoxGroup& group, std::uint32_t lane, const AabbTree::BoxGroup& other, std::uint32_t other_lane) {
  bool larger = false;
  for (int axis = 0; axis < 3; ++axis) {
    float &own_lo = group.lo[axis][lane], &own_hi = group.hi[axis][lane];
    const float lo = other.lo[axis][other_lane], hi = other.hi[axis][other_lane];
    larger |= lo < own_lo || hi > own_hi;
    own_lo = std::min(own_lo, lo);
    own_hi = std::max(own_hi, hi);
  }
  return larger;
}

}  // namespace

AabbTree::AabbTree(std::vector<Box3> boxes, std::span<const Triangle> triangles)
    : boxes_(std::move(boxes)), place_(boxes_.size(), ~0u) {
  Box3 all;
  CurveOrder sorted;
  sorted.reserve(boxes_.size());
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
    if (!boxes_[i].empty()) {
      all.add(boxes_[i]);
      sorted.push_back({0, i});
    }
  if (sorted.empty()) return;
  middle_ = 0.5 * all.lo + 0.5 * all.hi;
  // Cells are cubes, 2¹⁰ along the longest side: ten bits an axis.
  const double scale = 1023 / std::max((all.hi - all.lo).maxCoeff(), 1e-300);
  parallel_for((sorted.size() + width - 1) / width, 64, [&](std::size_t begin, std::size_t end) {
    Cells cells{};
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t first = b * width, count = std::min<std::size_t>(width, sorted.size() - first);
      for (std::size_t k = 0; k < count; ++k) {
        const Box3& box = boxes_[sorted[first + k].second];
        for (int axis = 0; axis < 3; ++axis)
          cells.at[axis][k] =
              static_cast<std::uint32_t>((0.5 * box.lo[axis] + 0.5 * box.hi[axis] - all.lo[axis]) * scale);
      }
      HWY_DYNAMIC_DISPATCH(hilbert_positions)(cells);
      for (std::size_t k = 0; k < count; ++k) sorted[first + k].first = cells.at[0][k];
    }
  });
  sort_by_position(sorted);
  order_.resize(sorted.size());
  if (!triangles.empty()) corners_.resize((sorted.size() + width - 1) / width);
  parallel_for(sorted.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto index = sorted[i].second;
      order_[i] = index;
      place_[index] = static_cast<std::uint32_t>(i);
      for (std::size_t k = 0; k < 3 && !triangles.empty(); ++k)
        corners_[i / width].v[k][i % width] = triangles[index][k];
    }
  });
  for (std::size_t size = order_.size(); levels_.size() < 2 || size > 1; size = levels_.back().size())
    levels_.push_back(empty_groups(size));
  fill();
  built_extents_ = sum_of_extents();
}

bool AabbTree::refit(std::vector<Box3>& boxes) {
  if (boxes.size() != boxes_.size()) return false;
  for (std::size_t i = 0; i < boxes.size() && order_.size() < boxes.size(); ++i)
    if (place_[i] == ~0u && !boxes[i].empty()) return false;
  boxes_ = std::move(boxes);
  if (!order_.empty()) fill();
  return true;
}

void AabbTree::fill() {
  parallel_for(levels_[0].size(), 64, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(fill_groups)(boxes_.data(), order_, middle_, begin, end, levels_);
  });
  for (std::size_t l = 1; l + 1 < levels_.size(); ++l)
    for (std::size_t i = 0; i < levels_[l].size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const BoxGroup& lower = levels_[l][i];
        levels_[l + 1][i / width].lo[axis][i % width] = *std::min_element(lower.lo[axis], lower.lo[axis] + width);
        levels_[l + 1][i / width].hi[axis][i % width] = *std::max_element(lower.hi[axis], lower.hi[axis] + width);
      }
}

void AabbTree::refit_or_rebuild(std::vector<Box3> boxes, std::span<const Triangle> triangles) {
  // Ratios of the sum of extents to that of construction. Above `largest`, groups overlap more and
  // queries slow down. Below `least`, the boxes are flat: they are so far from the origin of the
  // floats that these no longer resolve them. Both affect speed alone.
  constexpr double largest = 1.2, least = 0.2;
  if (!refit(boxes))
    *this = AabbTree(std::move(boxes), triangles);
  else if (const double size = sum_of_extents(); size > largest * built_extents_ || size < least * built_extents_)
    *this = AabbTree(std::move(boxes_), triangles);
}

double AabbTree::sum_of_extents() const {
  if (levels_.empty()) return 0;
  double sum = 0;
  for (const BoxGroup& b : levels_[1])
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t k = 0; k < width; ++k)
        if (b.lo[axis][k] <= b.hi[axis][k]) sum += double(b.hi[axis][k]) - double(b.lo[axis][k]);
  return sum;
}

void AabbTree::enlarge(std::uint32_t index, const Box3& box) {
  boxes_[index].add(box);
  std::uint32_t group = place_[index] / width;
  HWY_DYNAMIC_DISPATCH(fill_groups)(boxes_.data(), order_, middle_, group, group + 1, levels_);
  for (std::size_t l = 1; l + 1 < levels_.size() && extend(levels_[l + 1][group / width / width], group / width % width,
                                                           levels_[l][group / width], group % width);
       ++l)
    group /= width;
}

AabbTree::Pairs AabbTree::pairs(const std::vector<std::uint8_t>* marked,
                                const std::function<void(Pairs&)>& filter) const {
  return *pairs_up_to(std::numeric_limits<std::size_t>::max(), marked, filter);
}

std::optional<AabbTree::Pairs> AabbTree::pairs_up_to(std::size_t most, const std::vector<std::uint8_t>* marked,
                                                     const std::function<void(Pairs&)>& filter) const {
  if (levels_.empty()) return Pairs();
  std::vector<std::uint8_t> marked_places;
  if (marked) {
    marked_places.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) marked_places[i] = (*marked)[order_[i]];
  }
  std::vector<Pairs> found(levels_[1].size());  // by group of level 1
  std::atomic<std::size_t> total = 0;
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    Pairs some;
    for (std::size_t s = begin; s < end && total <= most; ++s) {
      some.clear();
      std::uint32_t queried[width] = {}, any = 0;  // lanes of each group of level 0
      for (std::size_t i = s * width * width; i < std::min(order_.size(), (s + 1) * width * width); ++i) {
        const auto bit = std::uint32_t(!marked || marked_places[i]) << i % width;
        queried[i / width % width] |= bit;
        any |= bit;
      }
      if (any == 0) continue;
      const auto own = static_cast<std::uint32_t>(s);
      HWY_DYNAMIC_DISPATCH(overlapping_groups)(levels_, own, marked ? 0 : own, near);
      for (std::uint32_t b = 0; b < width; ++b)
        if (queried[b] != 0) HWY_DYNAMIC_DISPATCH(pairs_of_group)
      (levels_, corners_.empty() ? nullptr : corners_.data(), own * width + b, queried[b],
       marked ? marked_places.data() : nullptr, near, some);
      std::size_t count = 0;
      for (const auto& [p, q] : some)
        if (const auto i = order_[p], j = order_[q]; boxes_[i].meets(boxes_[j]))
          some[count++] = {std::min(i, j), std::max(i, j)};
      some.resize(count);
      if (filter) filter(some);
      found[s].assign(some.begin(), some.end());
      total += some.size();
    }
  });
  if (total > most) return {};
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
