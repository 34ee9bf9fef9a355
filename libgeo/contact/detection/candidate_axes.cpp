// Five axes in lanes: difference of centroids, both normals, difference of closest points at the
// start and at the end. Compiled for each instruction set (base/simd_targets.h). Sums are never
// fused with products (-ffp-contract=off), so that all give the same results.
//
// At its own instant a difference of closest points has the largest separation of all directions,
// where the simplices are disjoint. So the cross products of edges of the usual separating-axis
// test are not needed.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/candidate_axes.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "contact/detection/candidate_axes.h"

// The source is included once for each instruction set.
#ifndef KERF_CANDIDATE_AXES_ONCE
#define KERF_CANDIDATE_AXES_ONCE
namespace geo {
namespace {

// The corners of a, then those of b.
struct Corners {
  alignas(64) double at[6][3][CandidateAxes::width];
};

// The features with the closest points, and parameters of the points. 0 to 8: edge feature / 3 of
// a with parameter s and edge feature % 3 of b with parameter t. 9 to 11: corner feature % 3 of a
// and the interior of b with parameters (s, t). 12 to 14: a corner of b and the interior of a.
struct ClosestFeatures {
  alignas(64) double feature[CandidateAxes::width], s[CandidateAxes::width], t[CandidateAxes::width];
};

// Input of the tilted axes n + τ c: `normal` n, `tilt` τ, `closest` c (unit difference of closest
// points). `at`: corners of a, then of b, at the start and at the end.
struct TiltInput {
  alignas(64) double normal[3][TiltedAxes::width], tilt[TiltedAxes::width];
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
using Doubles = hn::CappedTag<double, CandidateAxes::width>;
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
HWY_INLINE V product_difference(const V& a, const V& b, const V& c, const V& d) {
  return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {product_difference(a.y, b.z, a.z, b.y), product_difference(a.z, b.x, a.x, b.z),
          product_difference(a.x, b.y, a.y, b.x)};
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

// The closest points of two triangles so far, and their difference.
struct Closest {
  V squared;
  V3 difference;
  V feature, s, t;

  // Takes the difference of feature `number` where it is valid and shorter than the best so far.
  HWY_INLINE void offer(int number, const V3& offered, const V& at_s, const V& at_t, const hn::Mask<Doubles>& valid) {
    const V length = dot(offered, offered);
    const auto better = hn::And(valid, hn::Lt(length, squared));
    squared = hn::IfThenElse(better, length, squared);
    difference = {hn::IfThenElse(better, offered.x, difference.x), hn::IfThenElse(better, offered.y, difference.y),
                  hn::IfThenElse(better, offered.z, difference.z)};
    feature = hn::IfThenElse(better, hn::Set(Doubles(), double(number)), feature);
    s = hn::IfThenElse(better, at_s, s);
    t = hn::IfThenElse(better, at_t, t);
  }
};

// Offers the corners of p whose projections are inside q. `reverse`: p is triangle b, so that the
// difference changes its sign. s and t solve [uu uv; uv vv] (s, t) = (uw, vw).
HWY_INLINE void corners_over(const V3 (&p)[3], const V3 (&q)[3], int feature, bool reverse, Closest& best) {
  const Doubles d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const V3 u = q[1] - q[0], v = q[2] - q[0];
  const V uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), inverse_det = inverse(product_difference(uu, vv, uv, uv));
  for (int i = 0; i < 3; ++i) {
    const V3 w = p[i] - q[0];
    const V uw = dot(u, w), vw = dot(v, w);
    const V s = hn::Mul(product_difference(vv, uw, uv, vw), inverse_det),
            t = hn::Mul(product_difference(uu, vw, uv, uw), inverse_det);
    const auto inside = hn::And(hn::And(hn::Gt(s, zero), hn::Gt(t, zero)), hn::Lt(hn::Add(s, t), one));
    const V3 over = w - (s * u + t * v);
    best.offer(feature + i, reverse ? V3{zero, zero, zero} - over : over, s, t, inside);
  }
}

// Closest points of two disjoint triangles: the least over nine pairs of edges and six corners
// above the other's interior. Triangles that meet may give a positive distance.
HWY_INLINE Closest closest_of(const V3 (&a)[3], const V3 (&b)[3]) {
  const Doubles d;
  const V zero = hn::Zero(d);
  Closest best{.squared = hn::Set(d, std::numeric_limits<double>::infinity()),
               .difference = {zero, zero, zero},
               .feature = zero,
               .s = zero,
               .t = zero};
  V3 u[3], v[3];
  V uu[3], vv[3], inverse_uu[3], inverse_vv[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = a[(i + 1) % 3] - a[i];
    v[i] = b[(i + 1) % 3] - b[i];
    uu[i] = dot(u[i], u[i]);
    vv[i] = dot(v[i], v[i]);
    inverse_uu[i] = inverse(uu[i]);
    inverse_vv[i] = inverse(vv[i]);
  }
  const auto always = hn::Eq(zero, zero);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      // As in distance_between_segments(): closed form on the lines, clamped to [0, 1], then two
      // projections, to edge v and back to edge u.
      const V3 w = a[i] - b[j];
      const V uv = dot(u[i], v[j]), uw = dot(u[i], w), vw = dot(v[j], w);
      const V first =
          clamped(hn::Mul(product_difference(uv, vw, uw, vv[j]), inverse(product_difference(uu[i], vv[j], uv, uv))));
      const V t = clamped(hn::Mul(hn::Add(vw, hn::Mul(first, uv)), inverse_vv[j]));
      const V s = clamped(hn::Mul(hn::Sub(hn::Mul(t, uv), uw), inverse_uu[i]));
      best.offer(3 * i + j, w + (s * u[i] - t * v[j]), s, t, always);
    }
  corners_over(a, b, 9, false, best);
  corners_over(b, a, 12, true, best);
  return best;
}

}  // namespace

// Axes of all lanes at the corners `from` (start) and `to` (end). `end`: computes the axis of the
// closest points at the end, too. `features`: closest features at the start.
void compute_axes(const Corners& from, const Corners& to, bool end, CandidateAxes& out, ClosestFeatures& features) {
  const Doubles d;
  for (std::size_t lane = 0; lane < CandidateAxes::width; lane += hn::Lanes(d)) {
    V3 a[3], b[3], end_a[3], end_b[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = load(from, k, lane);
      b[k] = load(from, 3 + k, lane);
      end_a[k] = load(to, k, lane);
      end_b[k] = load(to, 3 + k, lane);
    }
    // Stores axis n = ± direction / |direction|, negated where `flip` is set, and its separations.
    // Normals are flipped so that they point from b to a, as the difference of centroids does.
    const auto put = [&](int axis, const V3& direction, const hn::Mask<Doubles>& flip) HWY_ATTR {
      const V length = hn::Sqrt(dot(direction, direction)), one = inverse(length);
      const V3 n = hn::IfThenElse(flip, hn::Neg(one), one) * direction;
      const auto least = [&](const V3(&p)[3])
                             HWY_ATTR { return hn::Min(hn::Min(dot(n, p[0]), dot(n, p[1])), dot(n, p[2])); };
      const auto most = [&](const V3(&p)[3])
                            HWY_ATTR { return hn::Max(hn::Max(dot(n, p[0]), dot(n, p[1])), dot(n, p[2])); };
      const V a_start = least(a), b_start = most(b), a_end = least(end_a), b_end = most(end_b);
      hn::Store(n.x, d, out.normal[axis][0] + lane), hn::Store(n.y, d, out.normal[axis][1] + lane),
          hn::Store(n.z, d, out.normal[axis][2] + lane);
      hn::Store(hn::Sub(a_start, b_start), d, out.start_separation[axis] + lane);
      hn::Store(hn::Sub(a_end, b_end), d, out.end_separation[axis] + lane);
      hn::Store(hn::Sub(hn::Min(a_start, a_end), hn::Max(b_start, b_end)), d, out.swept_separation[axis] + lane);
    };
    const V zero = hn::Zero(d);
    const auto never = hn::Lt(zero, zero);
    const V3 between = (a[0] + a[1] + a[2]) - (b[0] + b[1] + b[2]);
    put(CandidateAxes::between_centroids, between, never);
    const V3 normal_a = cross(a[1] - a[0], a[2] - a[0]), normal_b = cross(b[1] - b[0], b[2] - b[0]);
    put(CandidateAxes::a_normal, normal_a, hn::Lt(dot(normal_a, between), zero));
    put(CandidateAxes::b_normal, normal_b, hn::Lt(dot(normal_b, between), zero));
    const Closest closest = closest_of(a, b);
    put(CandidateAxes::between_closest, closest.difference, never);
    hn::Store(closest.feature, d, features.feature + lane);
    hn::Store(closest.s, d, features.s + lane);
    hn::Store(closest.t, d, features.t + lane);
    if (end) put(CandidateAxes::between_closest_at_end, closest_of(end_a, end_b).difference, never);
  }
}

// Unit axes n + τ c (zero where that is zero) and their separations min n · a − max n · b at both
// ends.
void compute_tilted(const TiltInput& input, TiltedAxes& out) {
  const Doubles d;
  for (std::size_t lane = 0; lane < TiltedAxes::width; lane += hn::Lanes(d)) {
    const V tilt = hn::Load(d, input.tilt + lane);
    V n[3];
    for (int k = 0; k < 3; ++k)
      n[k] = hn::Add(hn::Load(d, input.normal[k] + lane), hn::Mul(tilt, hn::Set(d, input.closest[k])));
    const auto along = [&](const V& x, const V& y, const V& z)
                           HWY_ATTR { return hn::Add(hn::Add(hn::Mul(n[0], x), hn::Mul(n[1], y)), hn::Mul(n[2], z)); };
    const V squared = along(n[0], n[1], n[2]);
    const V length = hn::IfThenElse(hn::Gt(squared, hn::Zero(d)), hn::Sqrt(squared), hn::Set(d, 1.0));
    for (int k = 0; k < 3; ++k) {
      n[k] = hn::Div(n[k], length);
      hn::Store(n[k], d, out.normal[k] + lane);
    }
    for (int end = 0; end < 2; ++end) {
      const auto at = [&](int corner) HWY_ATTR {
        return along(hn::Set(d, input.at[end][corner][0]), hn::Set(d, input.at[end][corner][1]),
                     hn::Set(d, input.at[end][corner][2]));
      };
      const V least = hn::Min(hn::Min(at(0), at(1)), at(2)), most = hn::Max(hn::Max(at(3), at(4)), at(5));
      hn::Store(hn::Sub(least, most), d, (end == 0 ? out.start_separation : out.end_separation) + lane);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(compute_axes);
HWY_EXPORT(compute_tilted);

void find_tilted_axes(const SimplexPair& pair, const CandidateAxes& axes, std::size_t lane,
                      const std::vector<Vec3>& from, const std::vector<Vec3>& to, TiltedAxes& out) {
  // Factors of c in n + τ c, where n is the unit normal of a, of b, or their sum. Surfaces that
  // slide over each other need a tilt of the order of their unevenness, which is not known: hence a
  // geometric series. It turns a unit n, where c is perpendicular to it, by 0.6° to 15°. A pair
  // that needs another tilt gets no axis here, which costs time or motion, but nothing crosses. The
  // last factor is padding.
  constexpr double tilt[] = {0, 0.01, 0.03, 0.09, 0.27, 0};
  TiltInput input;
  for (std::size_t i = 0; i < TiltedAxes::width; ++i) input.tilt[i] = tilt[i / 3];
  for (int axis = 0; axis < 3; ++axis) {
    const double a = axes.normal[CandidateAxes::a_normal][axis][lane],
                 b = axes.normal[CandidateAxes::b_normal][axis][lane], of[3] = {a, b, a + b};
    for (std::size_t i = 0; i < TiltedAxes::width; ++i) input.normal[axis][i] = of[i % 3];
    input.closest[axis] = axes.normal[CandidateAxes::between_closest][axis][lane];
    for (int k = 0; k < 6; ++k) {
      const Simplex& s = k < 3 ? pair.a : pair.b;
      const auto v = s.v[std::min(k % 3, s.size - 1)];
      input.at[0][k][axis] = from[v][axis];
      input.at[1][k][axis] = to[v][axis];
    }
  }
  HWY_DYNAMIC_DISPATCH(compute_tilted)(input, out);
}

void find_candidate_axes(const SimplexPair* pairs, std::size_t size, const std::vector<Vec3>& from,
                         const std::vector<Vec3>& to, bool end, CandidateAxes& out) {
  if (size == 0) return;
  Corners start_corners, end_corners;
  for (std::size_t lane = 0; lane < CandidateAxes::width; ++lane) {
    const SimplexPair& pair = pairs[std::min(lane, size - 1)];
    for (std::size_t k = 0; k < 6; ++k) {
      const Simplex& s = k < 3 ? pair.a : pair.b;
      const auto v = s.v[std::min<int>(static_cast<int>(k % 3), s.size - 1)];  // an edge is a degenerate triangle
      for (int axis = 0; axis < 3; ++axis) {
        start_corners.at[k][axis][lane] = from[v][axis];
        end_corners.at[k][axis][lane] = to[v][axis];
      }
    }
  }
  ClosestFeatures features;
  HWY_DYNAMIC_DISPATCH(compute_axes)(start_corners, end_corners, end, out, features);
  for (std::size_t lane = 0; lane < size; ++lane) {
    const int feature = static_cast<int>(features.feature[lane]);
    const double s = features.s[lane], t = features.t[lane];
    for (int k = 0; k < 3; ++k) out.weights_a[k][lane] = out.weights_b[k][lane] = 0;
    if (feature < 9) {
      out.weights_a[feature / 3][lane] = 1 - s;
      out.weights_a[(feature / 3 + 1) % 3][lane] = s;
      out.weights_b[feature % 3][lane] = 1 - t;
      out.weights_b[(feature % 3 + 1) % 3][lane] = t;
    } else {
      auto &corner = feature < 12 ? out.weights_a : out.weights_b,
           &interior = feature < 12 ? out.weights_b : out.weights_a;
      corner[feature % 3][lane] = 1;
      interior[0][lane] = 1 - s - t;
      interior[1][lane] = s;
      interior[2][lane] = t;
    }
  }
}

}  // namespace geo
#endif
