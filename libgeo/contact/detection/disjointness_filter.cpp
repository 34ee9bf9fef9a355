// Separating-plane and separating-edge tests of eight triangle pairs at a time. Signs of the
// determinants count only beyond the static error bounds of Shewchuk (1997); else the pair is kept.
//
// Compiled for each instruction set (base/simd_targets.h). Sums are never fused with products
// (-ffp-contract=off), so that error bounds hold.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/disjointness_filter.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <algorithm>

#include "contact/detection/disjointness_filter.h"
#include "geometry/predicates.h"

#ifndef KERF_DISJOINTNESS_FILTER  // once for all instruction sets
#define KERF_DISJOINTNESS_FILTER
namespace geo {

// Eight pairs of triangles.
struct PairLanes {
  static constexpr std::size_t width = 8;
  alignas(64) double at[2][3][3][width];   // coordinates, by triangle, corner and axis
  alignas(64) double vertex[2][3][width];  // indices, by triangle and corner
};

}  // namespace geo
#endif

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, PairLanes::width>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

struct Corners {
  V at[3][3], vertex[3];
};

HWY_INLINE Corners corners(const PairLanes& lanes, int which, std::size_t from) {
  const D d;
  Corners c;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) c.at[k][axis] = hn::Load(d, lanes.at[which][k][axis] + from);
    c.vertex[k] = hn::Load(d, lanes.vertex[which][k] + from);
  }
  return c;
}

// Where the error bounds hold: neither underflow nor overflow. `permanent`: the sum of absolute
// values of the terms of the determinant.
HWY_INLINE M in_filter_range(V permanent) {
  const D d;
  return hn::And(hn::Gt(permanent, hn::Set(d, filter_smallest)), hn::Lt(permanent, hn::Set(d, filter_largest)));
}

struct Normal {
  V at[3], permanent[3];  // differences of two products, and sums of their absolute values
};

HWY_INLINE Normal normal(const Corners& c) {
  Normal n;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const V plus = hn::Mul(hn::Sub(c.at[1][j], c.at[0][j]), hn::Sub(c.at[2][k], c.at[0][k]));
    const V minus = hn::Mul(hn::Sub(c.at[1][k], c.at[0][k]), hn::Sub(c.at[2][j], c.at[0][j]));
    n.at[i] = hn::Sub(plus, minus);
    n.permanent[i] = hn::Add(hn::Abs(plus), hn::Abs(minus));
  }
  return n;
}

// Whether the vertices of o that p does not share are strictly on one side of the plane of p.
// Determinant and bound are those of orient3d_filtered(), with the first corner of p as origin.
HWY_INLINE M on_one_side(const Corners& p, const Corners& o) {
  const D d;
  const Normal n = normal(p);
  M above = hn::Eq(p.vertex[0], p.vertex[0]), below = above, all_shared = above;  // true
  for (int k = 0; k < 3; ++k) {
    const M shared = hn::Or(hn::Eq(o.vertex[k], p.vertex[0]),
                            hn::Or(hn::Eq(o.vertex[k], p.vertex[1]), hn::Eq(o.vertex[k], p.vertex[2])));
    V det = hn::Zero(d), permanent = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const V x = hn::Sub(o.at[k][axis], p.at[0][axis]);
      det = hn::Add(det, hn::Mul(x, n.at[axis]));
      permanent = hn::Add(permanent, hn::Mul(hn::Abs(x), n.permanent[axis]));
    }
    const V bound = hn::Mul(hn::Set(d, orient3d_error), permanent);
    above = hn::And(above, hn::Or(shared, hn::And(in_filter_range(permanent), hn::Gt(det, bound))));
    below = hn::And(below, hn::Or(shared, hn::And(in_filter_range(permanent), hn::Lt(det, hn::Neg(bound)))));
    all_shared = hn::And(all_shared, shared);
  }
  return hn::AndNot(all_shared, hn::Or(above, below));
}

// A triangle projected along a coordinate axis.
struct Projected {
  V at[3][2], vertex[3];
};

// Projects along x, else along y, else along z: the dominant axis of the first triangle's normal.
HWY_INLINE Projected project(const Corners& c, M along_x, M along_y) {
  Projected s;
  for (int k = 0; k < 3; ++k) {
    s.at[k][0] = hn::IfThenElse(along_x, c.at[k][1], hn::IfThenElse(along_y, c.at[k][2], c.at[k][0]));
    s.at[k][1] = hn::IfThenElse(along_x, c.at[k][2], hn::IfThenElse(along_y, c.at[k][0], c.at[k][1]));
    s.vertex[k] = c.vertex[k];
  }
  return s;
}

// The determinant of orient2d_filtered() if the filter decides its sign, else 0.
HWY_INLINE V orientation(const V (&a)[2], const V (&b)[2], const V (&c)[2]) {
  const D d;
  const V left = hn::Mul(hn::Sub(a[0], c[0]), hn::Sub(b[1], c[1])),
          right = hn::Mul(hn::Sub(a[1], c[1]), hn::Sub(b[0], c[0]));
  const V value = hn::Sub(left, right), permanent = hn::Add(hn::Abs(left), hn::Abs(right));
  return hn::IfThenElseZero(
      hn::And(in_filter_range(permanent), hn::Gt(hn::Abs(value), hn::Mul(hn::Set(d, orient2d_error), permanent))),
      value);
}

// Whether o is strictly beyond an edge of p, except for vertices shared on that edge.
HWY_INLINE M beyond_an_edge(const Projected& p, const Projected& o) {
  const D d;
  const V own = orientation(p.at[0], p.at[1], p.at[2]);
  M some = hn::Ne(p.vertex[0], p.vertex[0]);  // false
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    M beyond = hn::Ne(own, hn::Zero(d));
    for (int j = 0; j < 3; ++j) {
      const M shared = hn::Or(hn::Eq(o.vertex[j], p.vertex[k]), hn::Eq(o.vertex[j], p.vertex[next]));
      const V other = orientation(p.at[k], p.at[next], o.at[j]);
      const M against = hn::Or(hn::And(hn::Gt(own, hn::Zero(d)), hn::Lt(other, hn::Zero(d))),
                               hn::And(hn::Lt(own, hn::Zero(d)), hn::Gt(other, hn::Zero(d))));
      beyond = hn::And(beyond, hn::Or(shared, against));
    }
    some = hn::Or(some, beyond);
  }
  return some;
}

HWY_INLINE M separated_by_planes(const Corners& s, const Corners& t) {
  return hn::Or(on_one_side(s, t), on_one_side(t, s));
}

HWY_INLINE M separated_by_edges(const Corners& s, const Corners& t) {
  const Normal n = normal(s);
  const V x = hn::Abs(n.at[0]), y = hn::Abs(n.at[1]), z = hn::Abs(n.at[2]);
  const M along_x = hn::And(hn::Ge(x, y), hn::Ge(x, z)), along_y = hn::Ge(y, z);
  const Projected p = project(s, along_x, along_y), q = project(t, along_x, along_y);
  return hn::Or(beyond_an_edge(p, q), beyond_an_edge(q, p));
}

// One bit a pair: whether the test is true.
template <class Test>
HWY_INLINE std::uint32_t pairs_where(const PairLanes& lanes, const Test& test) {
  const D d;
  std::uint32_t bits = 0;
  for (std::size_t from = 0; from < PairLanes::width; from += hn::Lanes(d)) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, test(corners(lanes, 0, from), corners(lanes, 1, from)), bytes);
    bits |= std::uint32_t(bytes[0]) << from;
  }
  return bits;
}

}  // namespace

// The pairs that are certainly disjoint, one bit a pair.
std::uint32_t disjoint_by_planes(const PairLanes& lanes) {
  return pairs_where(lanes, [](const Corners& s, const Corners& t) HWY_ATTR { return separated_by_planes(s, t); });
}
std::uint32_t disjoint_by_edges(const PairLanes& lanes) {
  return pairs_where(lanes, [](const Corners& s, const Corners& t) HWY_ATTR { return separated_by_edges(s, t); });
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(disjoint_by_planes);
HWY_EXPORT(disjoint_by_edges);
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Removes the pairs that the kernel finds disjoint. Unused lanes repeat the last pair.
template <class Kernel>
void remove_by(std::span<const Triangle> triangles, const std::vector<Vec3>& positions, Pairs& pairs,
               const Kernel& disjoint) {
  std::size_t kept = 0;
  PairLanes lanes;
  for (std::size_t first = 0; first < pairs.size(); first += PairLanes::width) {
    const std::size_t count = std::min(PairLanes::width, pairs.size() - first);
    for (std::size_t i = 0; i < PairLanes::width; ++i) {
      const auto [s, t] = pairs[first + std::min(i, count - 1)];
      for (int which = 0; which < 2; ++which)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto v = triangles[which == 0 ? s : t][k];
          lanes.vertex[which][k][i] = v;
          for (int axis = 0; axis < 3; ++axis) lanes.at[which][k][axis][i] = positions[v][axis];
        }
    }
    const std::uint32_t bits = disjoint(lanes);
    for (std::size_t i = 0; i < count; ++i) {
      pairs[kept] = pairs[first + i];
      kept += (bits >> i & 1) == 0;
    }
  }
  pairs.resize(kept);
}

}  // namespace

void remove_disjoint(std::span<const Triangle> triangles, const std::vector<Vec3>& positions, Pairs& pairs) {
  remove_by(triangles, positions, pairs,
            [](const PairLanes& lanes) { return HWY_DYNAMIC_DISPATCH(disjoint_by_planes)(lanes); });
  remove_by(triangles, positions, pairs,
            [](const PairLanes& lanes) { return HWY_DYNAMIC_DISPATCH(disjoint_by_edges)(lanes); });
}

}  // namespace geo
#endif
