// Nearest nodes by groups: the nodes of a small cell search together. Compiled for each instruction
// set (base/simd_targets.h), whose width changes the speed only.
//
//   1. Candidates within √reach of the cell's box are gathered once, as floats relative to the box.
//   2. Each node selects those within √reach of itself and ranks them by counting.
//   3. It puts the first k in exact order by doubles.
// The result holds when the last node is within reach, since all nodes left out are farther
// (NodeTree::Cell::gap).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "graph/nearest_lanes.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "base/bit_cast.h"
#include "graph/nearest_lanes.h"

#ifndef KERF_NEAREST_LANES_ONCE
#define KERF_NEAREST_LANES_ONCE
namespace geo {
namespace {

using Visit = std::function<void(NodeId, std::span<const NodeId>)>;

// Floats are in units of E, the half-width of the gathered box: coordinates are at most 1, within
// 2⁻²⁴ (1 + 2⁻²⁸) of the exact ones. A difference of two (at most 2) is off by η = 4.01 · 2⁻²⁴ at
// most. For a distance d ≤ 1 the sum of squares has two errors: 2 η √3 d + 3 η² from the
// coordinates, and 4 · 2⁻²⁴ d² from its own rounding. Their sum is below 18 · 2⁻²⁴.
constexpr double float_error = 0x1p-19;
// A candidate's index replaces the low bits of its squared distance, so that all keys differ. That
// changes the distance by a share of key_error at most.
constexpr std::uint32_t max_keyed = 2048, max_ranked = 255;
constexpr double key_error = 0x1p-12;

struct Exact {
  double square;
  std::uint32_t node;
  bool operator<(const Exact& o) const { return square != o.square ? square < o.square : node < o.node; }
};

struct Gathered {
  std::vector<float> along[3];
  std::vector<std::uint32_t> slot;
  std::size_t size = 0;
  void reserve(std::size_t more) {
    if (size + more <= slot.size()) return;
    const std::size_t n = 2 * (size + more);
    for (auto& a : along) a.resize(n);
    slot.resize(n);
  }
};

}  // namespace
}  // namespace geo
#endif

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class GroupSearch {
 public:
  GroupSearch(const NodeTree& tree, std::uint32_t k, const Visit& visit)
      : tree_(tree), k_(k), visit_(visit), row_(std::size_t(k) + 1) {
    wanted_ = static_cast<std::uint32_t>(std::min<std::size_t>(std::size_t(k) + 1, tree.size()));
  }

  void operator()(std::uint32_t group) {
    const auto cells = tree_.cells();
    const NodeTree::Cell& home = cells[group];
    // The smallest cell around the group with enough nodes bounds the distance of the last of them.
    std::uint32_t around = group;
    while (cells[around].count() < wanted_) around = cells[around].parent;
    const double farthest = cells[around].diagonal();
    // Factors 0.06 and 0.36 of the squared diagonal bound the first guess; a guess too small costs
    // another round, a guess too large more candidates. The result is the same.
    double reach = std::clamp(learned_, 0.06 * farthest, 0.36 * farthest);
    pending_.clear();
    for (auto slot = home.begin; slot < home.end; ++slot) pending_.push_back(slot);
    learned_ = 0;
    for (;;) {
      gather(home, reach);
      std::size_t open = 0;
      for (const auto slot : pending_)
        if (!search(slot, reach)) pending_[open++] = slot;
      pending_.resize(open);
      if (open == 0) break;
      // Squared: the distance grows by a factor of 1.26.
      reach = std::min(reach > 0 ? 1.6 * reach : farthest, farthest);
    }
    // The next group starts with 3 % more distance (6 % of its square).
    learned_ *= 1.06;
  }

 private:
  // All nodes within the square root of `reach` of the box of `home`, and perhaps some more.
  void gather(const NodeTree::Cell& home, double reach) {
    double widest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      middle_[axis] = 0.5 * home.lo[axis] + 0.5 * home.hi[axis];
      widest = std::max({widest, home.hi[axis] - middle_[axis], middle_[axis] - home.lo[axis]});
    }
    unit_ = widest + std::sqrt(reach);
    if (!(unit_ > 1e-150)) unit_ = 1;  // all at one place, as far as squares can tell
    scale_ = 1 / unit_;
    near_.size = 0;
    const auto cells = tree_.cells();
    stack_.assign(1, 0);
    while (!stack_.empty()) {
      const NodeTree::Cell& cell = cells[stack_.back()];
      stack_.pop_back();
      if (cell.leaf()) {
        gather_leaf(cell, home, reach);
        continue;
      }
      for (const auto child : {cell.children + 1, cell.children})
        if (cells[child].gap(home.lo, home.hi) <= reach) stack_.push_back(child);
    }
    // Whole vectors are read. Entries behind the last are far away.
    const hn::ScalableTag<float> d;
    near_.reserve(hn::Lanes(d));
    for (auto& a : near_.along) std::fill_n(a.begin() + static_cast<std::ptrdiff_t>(near_.size), hn::Lanes(d), 1e15f);
  }

  void gather_leaf(const NodeTree::Cell& cell, const NodeTree::Cell& home, double reach) {
    const hn::ScalableTag<double> dd;
    const hn::Rebind<float, decltype(dd)> df;
    const hn::Rebind<std::uint32_t, decltype(dd)> du;
    const std::size_t lanes = hn::Lanes(dd);
    // The first k + 1 of nodes at one position suffice: no node has others among its k nearest.
    const auto end = cell.count() > NodeTree::leaf_size
                         ? std::min(cell.end, cell.begin + std::max(wanted_, NodeTree::leaf_size))
                         : cell.end;
    near_.reserve(end - cell.begin + lanes);
    const auto limit = hn::Set(df, static_cast<float>(reach * scale_ * scale_ * (1 + 1e-6) + float_error));
    const auto zero = hn::Zero(df);
    for (std::size_t at = cell.begin; at < end; at += lanes) {
      const auto local = [&](int axis) {
        return hn::DemoteTo(df, hn::Mul(hn::Sub(hn::LoadU(dd, tree_.along(axis) + at), hn::Set(dd, middle_[axis])),
                                        hn::Set(dd, scale_)));
      };
      const auto x = local(0), y = local(1), z = local(2);
      const auto outside = [&](auto v, int axis) {
        const double half = std::max(home.hi[axis] - middle_[axis], middle_[axis] - home.lo[axis]);
        return hn::Max(hn::Sub(hn::Abs(v), hn::Set(df, static_cast<float>(half * scale_))), zero);
      };
      const auto gx = outside(x, 0), gy = outside(y, 1), gz = outside(z, 2);
      const auto gap = hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::Mul(gz, gz)));
      const auto mask = hn::And(hn::Le(gap, limit), hn::FirstN(df, end - at));
      hn::StoreU(hn::Compress(x, mask), df, near_.along[0].data() + near_.size);
      hn::StoreU(hn::Compress(y, mask), df, near_.along[1].data() + near_.size);
      hn::StoreU(hn::Compress(z, mask), df, near_.along[2].data() + near_.size);
      hn::StoreU(hn::Compress(hn::Iota(du, static_cast<std::uint32_t>(at)), hn::RebindMask(du, mask)), du,
                 near_.slot.data() + near_.size);
      near_.size += hn::CountTrue(df, mask);
    }
  }

  // The row of one node, if all of it is within reach.
  bool search(std::uint32_t slot, double reach) {
    const hn::ScalableTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const std::size_t lanes = hn::Lanes(d);
    const bool keyed = near_.size <= max_keyed;
    if (key_.size() < near_.size + 5 * lanes) key_.resize(2 * near_.size + 5 * lanes);
    double p[3];
    for (int axis = 0; axis < 3; ++axis) p[axis] = tree_.along(axis)[slot];
    const auto local = [&](int axis) { return hn::Set(d, static_cast<float>((p[axis] - middle_[axis]) * scale_)); };
    const auto px = local(0), py = local(1), pz = local(2);
    const auto limit = hn::Set(d, static_cast<float>(reach * scale_ * scale_ * (1 + 1e-6) + float_error));
    const auto kept = hn::Set(du, keyed ? ~(max_keyed - 1) : 0u);
    const float *const near_x = near_.along[0].data(), *const near_y = near_.along[1].data(),
                       *const near_z = near_.along[2].data();
    std::uint32_t* const keys = key_.data();
    std::uint32_t count = 0;
    auto at = hn::Iota(du, 0u);
    const auto step = hn::Set(du, static_cast<std::uint32_t>(lanes));
    for (std::size_t i = 0; i < near_.size; i += lanes) {
      const auto x = hn::Sub(hn::LoadU(d, near_x + i), px), y = hn::Sub(hn::LoadU(d, near_y + i), py),
                 z = hn::Sub(hn::LoadU(d, near_z + i), pz);
      const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const auto mask = hn::RebindMask(du, hn::Le(square, limit));
      hn::StoreU(hn::Compress(hn::Or(hn::And(hn::BitCast(du, square), kept), at), mask), du, keys + count);
      count += static_cast<std::uint32_t>(hn::CountTrue(du, mask));
      at = hn::Add(at, step);
    }
    if (count < wanted_) return false;
    if (exact_.size() < count) exact_.resize(2 * count);
    const auto exact = [&](std::uint32_t which) {
      const auto s = near_.slot[which];
      return Exact{square_of(tree_.along(0)[s] - p[0], tree_.along(1)[s] - p[1], tree_.along(2)[s] - p[2]),
                   tree_.nodes()[s]};
    };
    if (keyed && count <= max_ranked) {
      rank(count, exact);
    } else {
      for (std::uint32_t i = 0; i < count; ++i) exact_[i] = exact(keyed ? keys[i] & (max_keyed - 1) : keys[i]);
      std::nth_element(exact_.begin(), exact_.begin() + (wanted_ - 1), exact_.begin() + count);
      std::sort(exact_.begin(), exact_.begin() + wanted_);
    }
    if (exact_[wanted_ - 1].square > reach) return false;
    learned_ = std::max(learned_, exact_[wanted_ - 1].square);
    const auto self = tree_.nodes()[slot];
    std::uint32_t length = 0;
    for (std::uint32_t i = 0; i < wanted_ && length < k_; ++i) {
      row_[length] = NodeId(exact_[i].node);
      length += exact_[i].node != self;
    }
    visit_(NodeId(self), std::span<const NodeId>(row_.data(), length));
    return true;
  }

  // Puts the first `wanted_` candidates into `exact_`, in order. Candidates that rounding may have
  // put behind them are sorted, too.
  template <class ToExact>
  void rank(std::uint32_t count, const ToExact& exact) {
    const hn::ScalableTag<std::uint32_t> du;
    const std::size_t lanes = hn::Lanes(du);
    const auto one = hn::Set(du, 1u);
    const std::uint32_t* const keys = key_.data();
    for (std::size_t at = 0; at < count; at += 3 * lanes) {
      const auto a = hn::LoadU(du, keys + at), b = hn::LoadU(du, keys + at + lanes),
                 c = hn::LoadU(du, keys + at + 2 * lanes);
      auto below_a = hn::Zero(du), below_b = below_a, below_c = below_a;
      for (std::uint32_t j = 0; j < count; ++j) {
        const auto key = hn::Set(du, keys[j]);
        below_a = hn::IfThenElse(hn::Lt(key, a), hn::Add(below_a, one), below_a);
        below_b = hn::IfThenElse(hn::Lt(key, b), hn::Add(below_b, one), below_b);
        below_c = hn::IfThenElse(hn::Lt(key, c), hn::Add(below_c, one), below_c);
      }
      hn::StoreU(below_a, du, rank_ + at);
      hn::StoreU(below_b, du, rank_ + at + lanes);
      hn::StoreU(below_c, du, rank_ + at + 2 * lanes);
    }
    for (std::uint32_t i = 0; i < count; ++i) order_[rank_[i]] = keys[i];
    const float square = bit_cast<float>(order_[wanted_ - 1]);
    const auto last =
        bit_cast<std::uint32_t>(square * static_cast<float>(1 + 4 * key_error) + static_cast<float>(2 * float_error));
    std::uint32_t taken = wanted_;
    while (taken < count && order_[taken] <= last) ++taken;
    // As a rule floats give the exact order already.
    for (std::uint32_t i = 0; i < taken; ++i) exact_[i] = exact(order_[i] & (max_keyed - 1));
    bool ascend = true;
    for (std::uint32_t i = 1; i < taken; ++i) ascend &= exact_[i - 1].square < exact_[i].square;
    if (ascend) return;
    for (std::uint32_t i = 1; i < taken; ++i) {
      const Exact mine = exact_[i];
      std::uint32_t j = i;
      for (; j > 0 && mine < exact_[j - 1]; --j) exact_[j] = exact_[j - 1];
      exact_[j] = mine;
    }
  }

  const NodeTree& tree_;
  const std::uint32_t k_;
  const Visit& visit_;
  std::uint32_t wanted_;  // of the nearest, the node itself included
  double learned_ = 0;    // the farthest last of a row in the group before, squared
  double middle_[3], unit_ = 1, scale_ = 1;
  Gathered near_;
  std::vector<std::uint32_t> pending_, stack_, key_;  // key_: the squares of a node's candidates, and which they are
  std::vector<Exact> exact_;
  std::vector<NodeId> row_;
  std::uint32_t rank_[2 * max_ranked], order_[max_ranked];
};

void nearest_of_groups(const NodeTree& tree, std::span<const std::uint32_t> groups, std::uint32_t k,
                       const Visit& visit) {
  GroupSearch search(tree, k, visit);
  for (const auto group : groups) search(group);
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(nearest_of_groups);
void nearest_of_groups(const NodeTree& tree, std::span<const std::uint32_t> groups, std::uint32_t k,
                       const Visit& visit) {
  HWY_DYNAMIC_DISPATCH(nearest_of_groups)(tree, groups, k, visit);
}
}  // namespace geo
#endif
