// exact_by_integers of geometry/exact_predicates.h. Doubles are whole multiples of a common power
// of two, by which the coordinates of a predicate are divided: its determinants are then sums of
// products of whole numbers. Intersections follow from orientations.
#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <utility>

#include "geometry/coordinate_order.h"
#include "geometry/exact_predicates.h"
#include "geometry/predicates.h"

namespace geo {
namespace by_integers {
namespace {

namespace mp = boost::multiprecision;

// Determinants of differences of up to this many bits fit into Fixed, six summands of three
// factors each, a million times.
constexpr int fixed_bits = 512, difference_bits = (fixed_bits - 3 - 20) / 3;
using Fixed =
    mp::number<mp::cpp_int_backend<fixed_bits, fixed_bits, mp::signed_magnitude, mp::unchecked, void>, mp::et_off>;
using Unlimited = mp::number<mp::cpp_int_backend<>, mp::et_off>;

// x = whole · 2^power, with an odd whole; 0 has no bits.
struct Bits {
  std::int64_t whole = 0;
  int power = 0;
  explicit Bits(double x) {
    if (x == 0) return;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
    const std::uint64_t fraction = bits & ((std::uint64_t(1) << 52) - 1);
    const std::uint64_t digits = exponent == 0 ? fraction : fraction | std::uint64_t(1) << 52;
    const int zeros = std::countr_zero(digits);
    whole = static_cast<std::int64_t>(digits >> zeros);
    power = std::max(exponent, 1) - 1075 + zeros;
    if (x < 0) whole = -whole;
  }
  // x, not 0, is below 2^end() in magnitude.
  int end() const { return power + static_cast<int>(std::bit_width(static_cast<std::uint64_t>(std::abs(whole)))); }
};

// The powers of two between which the bits of some coordinates are.
struct Range {
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
  void add(double x) {
    if (x == 0) return;
    const Bits bits(x);
    low = std::min(low, bits.power);
    high = std::max(high, bits.end());
  }
  template <class Vector>
  void add_all(const Vector& p) {
    for (Eigen::Index i = 0; i < p.size(); ++i) add(p[i]);
  }
  // Whether differences of the coordinates, divided by 2^low, fit into Fixed's.
  bool fits() const { return low > high || high - low < difference_bits; }
};

template <class Number>
Number scaled(double x, int low) {
  const Bits bits(x);
  return bits.whole == 0 ? Number(0) : Number(bits.whole) << static_cast<unsigned>(bits.power - low);
}

template <class Number>
using Row = std::array<Number, 3>;

template <class Number>
Row<Number> difference(const Vec3& p, const Vec3& q, int low) {
  Row<Number> d;
  for (int i = 0; i < 3; ++i) d[i] = p[i] == q[i] ? Number(0) : scaled<Number>(p[i], low) - scaled<Number>(q[i], low);
  return d;
}

template <class Number>
Number minor_of(const Row<Number>& u, const Row<Number>& v, int i, int j) {
  return u[i] * v[j] - u[j] * v[i];
}

template <class Number>
Number determinant(const Row<Number>& u, const Row<Number>& v, const Row<Number>& w) {
  return u[0] * minor_of(v, w, 1, 2) + u[1] * minor_of(v, w, 2, 0) + u[2] * minor_of(v, w, 0, 1);
}

// Calls of(Fixed()) where the coordinates fit, else of(Unlimited()).
template <class Of>
auto with_numbers(const Range& range, const Of& of) {
  return range.fits() ? of(Fixed()) : of(Unlimited());
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Range range;
  for (const Vec3* p : {&a, &b, &c, &d}) range.add_all(*p);
  return with_numbers(range, [&]<class Number>(const Number&) {
    const auto u = difference<Number>(b, a, range.low), v = difference<Number>(c, a, range.low),
               w = difference<Number>(d, a, range.low);
    return determinant(u, v, w).sign();
  });
}

int orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  Range range;
  for (const Vec2* p : {&a, &b, &c}) range.add_all(*p);
  return with_numbers(range, [&]<class Number>(const Number&) {
    const auto at = [&](const Vec2& p, int i) { return scaled<Number>(p[i], range.low); };
    const Number ux = at(a, 0) - at(c, 0), uy = at(a, 1) - at(c, 1);
    const Number vx = at(b, 0) - at(c, 0), vy = at(b, 1) - at(c, 1);
    return Number(ux * vy - uy * vx).sign();
  });
}

// orient3d() and orient2d() with filters. Intersections consist of many orientations, few of which
// are degenerate.
int side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  int sign = orient3d_filtered(a, b, c, d);
  if (sign == 2) sign = orient3d_refined(a, b, c, d);
  return sign != 2 ? sign : orient3d(a, b, c, d);
}
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int sign = orient2d_filtered(a, b, c, axis);
  if (sign != 2) return sign;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  if ((a[i] == b[i] && a[i] == c[i]) || (a[j] == b[j] && a[j] == c[j])) return 0;
  const Vec2 p(a[i], a[j]), q(b[i], b[j]), r(c[i], c[j]);
  return p == q || q == r || r == p ? 0 : orient2d(p, q, r);
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return turn(a, b, c, 0) == 0 && turn(a, b, c, 1) == 0 && turn(a, b, c, 2) == 0;
}

// An axis along which the projection of abc has an area; −1: none has.
int axis_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (turn(a, b, c, axis) != 0) return axis;
  return -1;
}

int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int axis = axis_of(a, b, c);
  return axis < 0 ? 0 : turn(a, b, c, axis) * turn(a, b, d, axis);
}

// Whether a point of the line through a and b is between them, or one of them.
bool between(const Vec3& a, const Vec3& b, const Vec3& p) {
  const auto [low, high] = std::minmax(a, b, is_before);
  return !is_before(p, low) && !is_before(high, p);
}

bool on_segment(const Vec3& a, const Vec3& b, const Vec3& p) { return collinear(a, b, p) && between(a, b, p); }

// Both for points in one plane, in which the projection along the axis keeps areas apart from 0.
bool in_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, int axis) {
  const int inside = turn(a, b, c, axis);
  return turn(a, b, p, axis) != -inside && turn(b, c, p, axis) != -inside && turn(c, a, p, axis) != -inside;
}
bool segments_meet_in_plane(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, int axis) {
  const int tr = turn(p, q, r, axis), ts = turn(p, q, s, axis);
  if (tr == 0 && ts == 0) return between(p, q, r) || between(p, q, s) || between(r, s, p);
  return tr * ts <= 0 && turn(r, s, p, axis) * turn(r, s, q, axis) <= 0;
}

bool on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  return side(a, b, c, p) == 0 && in_triangle(a, b, c, p, axis_of(a, b, c));
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  if (side(p, q, r, s) != 0) return false;
  int axis = axis_of(p, q, r);
  if (axis < 0) axis = axis_of(p, q, s);
  if (axis < 0) return between(p, q, r) || between(p, q, s) || between(r, s, p);
  return segments_meet_in_plane(p, q, r, s, axis);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int sp = side(a, b, c, p), sq = side(a, b, c, q);
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) {
    const int axis = axis_of(a, b, c);
    return in_triangle(a, b, c, p, axis) || segments_meet_in_plane(p, q, a, b, axis) ||
           segments_meet_in_plane(p, q, b, c, axis) || segments_meet_in_plane(p, q, c, a, axis);
  }
  const int x = side(p, q, a, b), y = side(p, q, b, c), z = side(p, q, c, a);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  for (int k = 0; k < 3; ++k)
    if (segment_meets_triangle(s[k], s[(k + 1) % 3], t[0], t[1], t[2]) ||
        segment_meets_triangle(t[k], t[(k + 1) % 3], s[0], s[1], s[2]))
      return true;
  return false;
}

int volume_sign(std::span<const std::array<Vec3, 3>> triangles) {
  Range range;
  for (const auto& corners : triangles)
    for (const Vec3& p : corners) range.add_all(p);
  const Vec3 apex = triangles[0][0];
  const auto sum_of = [&]<class Number>(const Number&) {
    Number sum = 0;
    for (const auto& corners : triangles)
      sum +=
          determinant(difference<Number>(corners[0], apex, range.low), difference<Number>(corners[1], apex, range.low),
                      difference<Number>(corners[2], apex, range.low));
    return sum.sign();
  };
  constexpr std::size_t most = 1 << 20;  // summands for which Fixed has bits
  return triangles.size() <= most ? with_numbers(range, sum_of) : sum_of(Unlimited());
}

}  // namespace

constexpr ExactPredicates all{.orient3d = orient3d,
                              .orient2d = orient2d,
                              .collinear = collinear,
                              .coplanar_side = coplanar_side,
                              .on_segment = on_segment,
                              .on_triangle = on_triangle,
                              .segments_meet = segments_meet,
                              .segment_meets_triangle = segment_meets_triangle,
                              .triangles_meet = triangles_meet,
                              .volume_sign = volume_sign};

}  // namespace by_integers

constexpr ExactPredicates exact_by_integers = by_integers::all;

}  // namespace geo
