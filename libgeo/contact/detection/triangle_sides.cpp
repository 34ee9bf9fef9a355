// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is
// taken at run time. No sum is fused with a product, so that error bounds hold.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/triangle_sides.cpp"
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)  // vectors that no structure can hold
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <algorithm>

#include "contact/detection/triangle_sides.h"
#include "geometry/predicates.h"

#ifndef KERF_TRIANGLE_SIDES  // for all kinds of vectors
#define KERF_TRIANGLE_SIDES
namespace geo {

// Pairs of triangles side by side.
struct PairLanes {
  static constexpr std::size_t width = 8;
  alignas(64) double at[2][3][3][width];  // of each triangle, corner and axis
  alignas(64) double row[2][3][width];
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
  V at[3][3], row[3];
};

HWY_INLINE Corners corners(const PairLanes& lanes, int which, std::size_t from) {
  const D d;
  Corners c;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) c.at[k][axis] = hn::Load(d, lanes.at[which][k][axis] + from);
    c.row[k] = hn::Load(d, lanes.row[which][k] + from);
  }
  return c;
}

// Where error bounds hold.
HWY_INLINE M sure(V terms) {
  const D d;
  return hn::And(hn::Gt(terms, hn::Set(d, filter_smallest)), hn::Lt(terms, hn::Set(d, filter_largest)));
}

struct Normal {
  V at[3], terms[3];  // differences of two products, and the sums of their absolute values
};

HWY_INLINE Normal normal(const Corners& c) {
  Normal n;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const V plus = hn::Mul(hn::Sub(c.at[1][j], c.at[0][j]), hn::Sub(c.at[2][k], c.at[0][k]));
    const V minus = hn::Mul(hn::Sub(c.at[1][k], c.at[0][k]), hn::Sub(c.at[2][j], c.at[0][j]));
    n.at[i] = hn::Sub(plus, minus), n.terms[i] = hn::Add(hn::Abs(plus), hn::Abs(minus));
  }
  return n;
}

// Whether all corners of o that p does not have are strictly on one side of p's plane: the
// determinant of orient3d_filtered() with its bound, but taken relative to p's first corner.
HWY_INLINE M on_one_side(const Corners& p, const Corners& o) {
  const D d;
  const Normal n = normal(p);
  M above = hn::Eq(p.row[0], p.row[0]), below = above, all_shared = above;  // true
  for (int k = 0; k < 3; ++k) {
    const M shared = hn::Or(hn::Eq(o.row[k], p.row[0]), hn::Or(hn::Eq(o.row[k], p.row[1]), hn::Eq(o.row[k], p.row[2])));
    V det = hn::Zero(d), permanent = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const V x = hn::Sub(o.at[k][axis], p.at[0][axis]);
      det = hn::Add(det, hn::Mul(x, n.at[axis])), permanent = hn::Add(permanent, hn::Mul(hn::Abs(x), n.terms[axis]));
    }
    const V bound = hn::Mul(hn::Set(d, 7.771561172376103e-16), permanent);
    above = hn::And(above, hn::Or(shared, hn::And(sure(permanent), hn::Gt(det, bound))));
    below = hn::And(below, hn::Or(shared, hn::And(sure(permanent), hn::Lt(det, hn::Neg(bound)))));
    all_shared = hn::And(all_shared, shared);
  }
  return hn::AndNot(all_shared, hn::Or(above, below));
}

// Seen along an axis.
struct Seen {
  V at[3][2], row[3];
};

HWY_INLINE Seen seen(const Corners& c, M along_x, M along_y) {
  Seen s;
  for (int k = 0; k < 3; ++k) {
    s.at[k][0] = hn::IfThenElse(along_x, c.at[k][1], hn::IfThenElse(along_y, c.at[k][2], c.at[k][0]));
    s.at[k][1] = hn::IfThenElse(along_x, c.at[k][2], hn::IfThenElse(along_y, c.at[k][0], c.at[k][1]));
    s.row[k] = c.row[k];
  }
  return s;
}

// The turn abc where its sign is sure, as orient2d_filtered() has it; else zero.
HWY_INLINE V turn(const V (&a)[2], const V (&b)[2], const V (&c)[2]) {
  const D d;
  const V left = hn::Mul(hn::Sub(a[0], c[0]), hn::Sub(b[1], c[1])),
          right = hn::Mul(hn::Sub(a[1], c[1]), hn::Sub(b[0], c[0]));
  const V value = hn::Sub(left, right), terms = hn::Add(hn::Abs(left), hn::Abs(right));
  return hn::IfThenElseZero(
      hn::And(sure(terms), hn::Gt(hn::Abs(value), hn::Mul(hn::Set(d, 3.3306690738754716e-16), terms))), value);
}

// Whether an edge of p has o strictly on its far side, but for corners that the two share on it.
HWY_INLINE M divides(const Seen& p, const Seen& o) {
  const D d;
  const V own = turn(p.at[0], p.at[1], p.at[2]);
  M some = hn::Ne(p.row[0], p.row[0]);  // false
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    M beyond = hn::Ne(own, hn::Zero(d));
    for (int j = 0; j < 3; ++j) {
      const M shared = hn::Or(hn::Eq(o.row[j], p.row[k]), hn::Eq(o.row[j], p.row[next]));
      const V other = turn(p.at[k], p.at[next], o.at[j]);
      const M against = hn::Or(hn::And(hn::Gt(own, hn::Zero(d)), hn::Lt(other, hn::Zero(d))),
                               hn::And(hn::Lt(own, hn::Zero(d)), hn::Gt(other, hn::Zero(d))));
      beyond = hn::And(beyond, hn::Or(shared, against));
    }
    some = hn::Or(some, beyond);
  }
  return some;
}

HWY_INLINE M apart_by_planes(const Corners& s, const Corners& t) {
  return hn::Or(on_one_side(s, t), on_one_side(t, s));
}

HWY_INLINE M apart_by_edges(const Corners& s, const Corners& t) {
  const Normal n = normal(s);
  const V x = hn::Abs(n.at[0]), y = hn::Abs(n.at[1]), z = hn::Abs(n.at[2]);
  const M along_x = hn::And(hn::Ge(x, y), hn::Ge(x, z)), along_y = hn::Ge(y, z);
  const Seen p = seen(s, along_x, along_y), q = seen(t, along_x, along_y);
  return hn::Or(divides(p, q), divides(q, p));
}

template <class Apart>
HWY_INLINE std::uint32_t which(const PairLanes& lanes, const Apart& apart) {
  const D d;
  std::uint32_t bits = 0;
  for (std::size_t from = 0; from < PairLanes::width; from += hn::Lanes(d)) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, apart(corners(lanes, 0, from), corners(lanes, 1, from)), bytes);
    bits |= std::uint32_t(bytes[0]) << from;
  }
  return bits;
}

}  // namespace

// Bits of the pairs that are clear.
std::uint32_t clear_by_planes(const PairLanes& lanes) {
  return which(lanes, [](const Corners& s, const Corners& t) HWY_ATTR { return apart_by_planes(s, t); });
}
std::uint32_t clear_by_edges(const PairLanes& lanes) {
  return which(lanes, [](const Corners& s, const Corners& t) HWY_ATTR { return apart_by_edges(s, t); });
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(clear_by_planes);
HWY_EXPORT(clear_by_edges);
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Those not in `clear`, which is asked about some at a time. The last ones are in the lanes that
// are left, too.
template <class Clear>
void leave_out(std::span<const Triangle> triangles, const std::vector<Vec3>& positions, Pairs& pairs,
               const Clear& clear) {
  std::size_t kept = 0;
  PairLanes lanes;
  for (std::size_t first = 0; first < pairs.size(); first += PairLanes::width) {
    const std::size_t count = std::min(PairLanes::width, pairs.size() - first);
    for (std::size_t i = 0; i < PairLanes::width; ++i) {
      const auto [s, t] = pairs[first + std::min(i, count - 1)];
      for (int which = 0; which < 2; ++which)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto row = triangles[which == 0 ? s : t][k];
          lanes.row[which][k][i] = row;
          for (int axis = 0; axis < 3; ++axis) lanes.at[which][k][axis][i] = positions[row][axis];
        }
    }
    const std::uint32_t bits = clear(lanes);
    for (std::size_t i = 0; i < count; ++i) {
      pairs[kept] = pairs[first + i];
      kept += (bits >> i & 1) == 0;
    }
  }
  pairs.resize(kept);
}

}  // namespace

void keep_unclear(std::span<const Triangle> triangles, const std::vector<Vec3>& positions, Pairs& pairs) {
  leave_out(triangles, positions, pairs,
            [](const PairLanes& lanes) { return HWY_DYNAMIC_DISPATCH(clear_by_planes)(lanes); });
  leave_out(triangles, positions, pairs,
            [](const PairLanes& lanes) { return HWY_DYNAMIC_DISPATCH(clear_by_edges)(lanes); });
}

}  // namespace geo
#endif
