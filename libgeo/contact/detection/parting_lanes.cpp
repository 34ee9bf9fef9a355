// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is taken at run time.
// No sum is fused with a product, so all give the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/parting_lanes.cpp"
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)  // vectors that no structure can hold
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "contact/detection/parting_lanes.h"

#ifndef KERF_PARTING_LANES_ONCE
#define KERF_PARTING_LANES_ONCE
namespace geo {
namespace {

// Corners of a, then of b.
struct Corners {
  alignas(64) double at[6][3][Partings::width];
};

// Closest places. 0 to 8: s along edge which / 3 of a, t along edge which % 3 of b; 9 to 11: a corner of a, and (s, t)
// inside b; 12 to 14: the reverse.
struct Places {
  alignas(64) double which[Partings::width], s[Partings::width], t[Partings::width];
};

// What tilted directions are made of, and the corners of a and b that they may part, at the beginning and at the end.
struct Tilts {
  alignas(64) double normal[3][TiltedPartings::width], tilt[TiltedPartings::width];
  double closest[3], at[2][6][3];
};

}  // namespace
}  // namespace geo
#endif

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, Partings::width>;
using V = hn::Vec<Doubles>;
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE V3 operator*(const V& s, const V3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V difference(const V& a, const V& b, const V& c, const V& d) {
  return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {difference(a.y, b.z, a.z, b.y), difference(a.z, b.x, a.x, b.z), difference(a.x, b.y, a.y, b.x)};
}
HWY_INLINE V clamped(const V& x) { return hn::Min(hn::Max(x, hn::Zero(Doubles())), hn::Set(Doubles(), 1.0)); }
// 1 / x where x > 0, else 0.
HWY_INLINE V inverse(const V& x) {
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(Doubles())), hn::Div(hn::Set(Doubles(), 1.0), x));
}
HWY_INLINE V3 load(const Corners& c, int corner, std::size_t lane) {
  const Doubles d;
  return {hn::Load(d, c.at[corner][0] + lane), hn::Load(d, c.at[corner][1] + lane),
          hn::Load(d, c.at[corner][2] + lane)};
}

// The closest places of two triangles, and their difference.
struct Closest {
  V squared;
  V3 apart;
  V which, s, t;

  HWY_INLINE void offer(int number, const V3& candidate, const V& at_s, const V& at_t, const hn::Mask<Doubles>& valid) {
    const V length = dot(candidate, candidate);
    const auto better = hn::And(valid, hn::Lt(length, squared));
    squared = hn::IfThenElse(better, length, squared);
    apart = {hn::IfThenElse(better, candidate.x, apart.x), hn::IfThenElse(better, candidate.y, apart.y),
             hn::IfThenElse(better, candidate.z, apart.z)};
    which = hn::IfThenElse(better, hn::Set(Doubles(), double(number)), which);
    s = hn::IfThenElse(better, at_s, s), t = hn::IfThenElse(better, at_t, t);
  }
};

// Corners of p over the inside of q.
HWY_INLINE void corners_over(const V3 (&p)[3], const V3 (&q)[3], int which, bool reverse, Closest& best) {
  const Doubles d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const V3 u = q[1] - q[0], v = q[2] - q[0];
  const V uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), inverse_det = inverse(difference(uu, vv, uv, uv));
  for (int i = 0; i < 3; ++i) {
    const V3 w = p[i] - q[0];
    const V uw = dot(u, w), vw = dot(v, w);
    const V s = hn::Mul(difference(vv, uw, uv, vw), inverse_det), t = hn::Mul(difference(uu, vw, uv, uw), inverse_det);
    const auto inside = hn::And(hn::And(hn::Gt(s, zero), hn::Gt(t, zero)), hn::Lt(hn::Add(s, t), one));
    const V3 over = w - (s * u + t * v);
    best.offer(which + i, reverse ? V3{zero, zero, zero} - over : over, s, t, inside);
  }
}

HWY_INLINE Closest closest_of(const V3 (&a)[3], const V3 (&b)[3]) {
  const Doubles d;
  const V zero = hn::Zero(d);
  Closest best{hn::Set(d, std::numeric_limits<double>::infinity()), {zero, zero, zero}, zero, zero, zero};
  V3 u[3], v[3];
  V uu[3], vv[3], inverse_uu[3], inverse_vv[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = a[(i + 1) % 3] - a[i], v[i] = b[(i + 1) % 3] - b[i];
    uu[i] = dot(u[i], u[i]), vv[i] = dot(v[i], v[i]), inverse_uu[i] = inverse(uu[i]), inverse_vv[i] = inverse(vv[i]);
  }
  const auto always = hn::Eq(zero, zero);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      // The best place on the first line, then the best for it on the second, then for that on the first again.
      const V3 w = a[i] - b[j];
      const V uv = dot(u[i], v[j]), uw = dot(u[i], w), vw = dot(v[j], w);
      const V first = clamped(hn::Mul(difference(uv, vw, uw, vv[j]), inverse(difference(uu[i], vv[j], uv, uv))));
      const V t = clamped(hn::Mul(hn::Add(vw, hn::Mul(first, uv)), inverse_vv[j]));
      const V s = clamped(hn::Mul(hn::Sub(hn::Mul(t, uv), uw), inverse_uu[i]));
      best.offer(3 * i + j, w + (s * u[i] - t * v[j]), s, t, always);
    }
  corners_over(a, b, 9, false, best);
  corners_over(b, a, 12, true, best);
  return best;
}

}  // namespace

void find_eight(const Corners& from, const Corners& to, bool end, Partings& out, Places& places) {
  const Doubles d;
  for (std::size_t lane = 0; lane < Partings::width; lane += hn::Lanes(d)) {
    V3 a[3], b[3], c[3], e[3];
    for (int k = 0; k < 3; ++k)
      a[k] = load(from, k, lane), b[k] = load(from, 3 + k, lane), c[k] = load(to, k, lane),
      e[k] = load(to, 3 + k, lane);
    const auto put = [&](int which, const V3& way, const hn::Mask<Doubles>& turn) HWY_ATTR {
      const V length = hn::Sqrt(dot(way, way)), one = inverse(length);
      const V3 n = hn::IfThenElse(turn, hn::Neg(one), one) * way;
      const auto least = [&](const V3(&p)[3])
                             HWY_ATTR { return hn::Min(hn::Min(dot(n, p[0]), dot(n, p[1])), dot(n, p[2])); };
      const auto most = [&](const V3(&p)[3])
                            HWY_ATTR { return hn::Max(hn::Max(dot(n, p[0]), dot(n, p[1])), dot(n, p[2])); };
      const V least_first = least(a), most_first = most(b), least_last = least(c), most_last = most(e);
      hn::Store(n.x, d, out.normal[which][0] + lane), hn::Store(n.y, d, out.normal[which][1] + lane),
          hn::Store(n.z, d, out.normal[which][2] + lane);
      hn::Store(hn::Sub(least_first, most_first), d, out.first[which] + lane);
      hn::Store(hn::Sub(least_last, most_last), d, out.last[which] + lane);
      hn::Store(hn::Sub(hn::Min(least_first, least_last), hn::Max(most_first, most_last)), d, out.always[which] + lane);
    };
    const V zero = hn::Zero(d);
    const auto as_it_is = hn::Lt(zero, zero);
    const V3 across = (a[0] + a[1] + a[2]) - (b[0] + b[1] + b[2]);
    put(Partings::across, across, as_it_is);
    const V3 of_a = cross(a[1] - a[0], a[2] - a[0]), of_b = cross(b[1] - b[0], b[2] - b[0]);
    put(Partings::a_normal, of_a, hn::Lt(dot(of_a, across), zero));
    put(Partings::b_normal, of_b, hn::Lt(dot(of_b, across), zero));
    const Closest closest = closest_of(a, b);
    put(Partings::closest, closest.apart, as_it_is);
    hn::Store(closest.which, d, places.which + lane), hn::Store(closest.s, d, places.s + lane),
        hn::Store(closest.t, d, places.t + lane);
    if (end) put(Partings::closest_at_end, closest_of(c, e).apart, as_it_is);
  }
}

void find_fifteen(const Tilts& tilts, TiltedPartings& out) {
  const Doubles d;
  for (std::size_t lane = 0; lane < TiltedPartings::width; lane += hn::Lanes(d)) {
    const V tilt = hn::Load(d, tilts.tilt + lane);
    V n[3];
    for (int k = 0; k < 3; ++k)
      n[k] = hn::Add(hn::Load(d, tilts.normal[k] + lane), hn::Mul(tilt, hn::Set(d, tilts.closest[k])));
    const auto along = [&](const V& x, const V& y, const V& z)
                           HWY_ATTR { return hn::Add(hn::Add(hn::Mul(n[0], x), hn::Mul(n[1], y)), hn::Mul(n[2], z)); };
    const V squared = along(n[0], n[1], n[2]);
    const V length = hn::IfThenElse(hn::Gt(squared, hn::Zero(d)), hn::Sqrt(squared), hn::Set(d, 1.0));
    for (int k = 0; k < 3; ++k) n[k] = hn::Div(n[k], length), hn::Store(n[k], d, out.normal[k] + lane);
    for (int end = 0; end < 2; ++end) {
      const auto at = [&](int corner) HWY_ATTR {
        return along(hn::Set(d, tilts.at[end][corner][0]), hn::Set(d, tilts.at[end][corner][1]),
                     hn::Set(d, tilts.at[end][corner][2]));
      };
      const V least = hn::Min(hn::Min(at(0), at(1)), at(2)), most = hn::Max(hn::Max(at(3), at(4)), at(5));
      hn::Store(hn::Sub(least, most), d, (end == 0 ? out.first : out.last) + lane);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(find_eight);
HWY_EXPORT(find_fifteen);

void find_tilted(const Couple& couple, const Partings& p, std::size_t lane, const std::vector<Vec3>& from,
                 const std::vector<Vec3>& to, TiltedPartings& out) {
  constexpr double tilt[] = {0, 0.01, 0.03, 0.09, 0.27, 0};
  Tilts tilts;
  for (std::size_t i = 0; i < TiltedPartings::width; ++i) tilts.tilt[i] = tilt[i / 3];
  for (int axis = 0; axis < 3; ++axis) {
    const double a = p.normal[Partings::a_normal][axis][lane], b = p.normal[Partings::b_normal][axis][lane],
                 of[3] = {a, b, a + b};
    for (std::size_t i = 0; i < TiltedPartings::width; ++i) tilts.normal[axis][i] = of[i % 3];
    tilts.closest[axis] = p.normal[Partings::closest][axis][lane];
    for (int k = 0; k < 6; ++k) {
      const Simplex& s = k < 3 ? couple.a : couple.b;
      const auto row = s.v[std::min(k % 3, s.size - 1)];
      tilts.at[0][k][axis] = from[row][axis], tilts.at[1][k][axis] = to[row][axis];
    }
  }
  HWY_DYNAMIC_DISPATCH(find_fifteen)(tilts, out);
}

void find_partings(const Couple* couples, std::size_t size, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                   bool end, Partings& out) {
  Corners first, last;
  for (std::size_t lane = 0; lane < Partings::width; ++lane) {
    const Couple& couple = couples[std::min(lane, size - 1)];
    for (std::size_t k = 0; k < 6; ++k) {
      const Simplex& s = k < 3 ? couple.a : couple.b;
      const auto row = s.v[std::min<int>(static_cast<int>(k % 3), s.size - 1)];  // an edge is a triangle without area
      for (int axis = 0; axis < 3; ++axis)
        first.at[k][axis][lane] = from[row][axis], last.at[k][axis][lane] = to[row][axis];
    }
  }
  Places places;
  HWY_DYNAMIC_DISPATCH(find_eight)(first, last, end, out, places);
  for (std::size_t lane = 0; lane < size; ++lane) {
    const int which = static_cast<int>(places.which[lane]);
    const double s = places.s[lane], t = places.t[lane];
    for (int k = 0; k < 3; ++k) out.from[k][lane] = out.to[k][lane] = 0;
    if (which < 9) {
      out.from[which / 3][lane] = 1 - s, out.from[(which / 3 + 1) % 3][lane] = s;
      out.to[which % 3][lane] = 1 - t, out.to[(which % 3 + 1) % 3][lane] = t;
    } else {
      auto &corner = which < 12 ? out.from : out.to, &inside = which < 12 ? out.to : out.from;
      corner[which % 3][lane] = 1;
      inside[0][lane] = 1 - s - t, inside[1][lane] = s, inside[2][lane] = t;
    }
  }
}

}  // namespace geo
#endif
