// Filtered orientations decide most cases (error bounds: Shewchuk 1997). Triangle pairs follow
// Guigue and Devillers (2003). Degenerate and undecided cases go to geometry/exact_predicates.h:
// KERF_EXACT is the set of the edition.
#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/coordinate_order.h"
#include "geometry/exact_predicates.h"

namespace geo {
namespace {

const ExactPredicates& exact = KERF_EXACT;

bool same(const Vec3& a, const Vec3& b) { return a == b; }

// The segment that a degenerate triangle is: the extreme ones of collinear points a, b, c.
std::pair<Vec3, Vec3> as_segment(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {std::min({a, b, c}, is_before), std::max({a, b, c}, is_before)};
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  if (same(p, q) && same(r, s)) return same(p, r);
  if (same(p, q)) return exact.on_segment(r, s, p);
  if (same(r, s)) return exact.on_segment(p, q, r);
  return exact.segments_meet(p, q, r, s);
}

// An unevaluated sum of two doubles, the second at most half an ulp of the first (Dekker).
struct Pair {
  double high, low;
};

Pair sum_of(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}
// As sum_of(), for |a| ≥ |b|.
Pair ordered_sum_of(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
Pair product_of(double a, double b) {
  constexpr double splitter = 0x1p27 + 1;
  const double p = a * b;
  const double x = splitter * a, ah = x - (x - a), al = a - ah;
  const double y = splitter * b, bh = y - (y - b), bl = b - bh;
  return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}
Pair operator-(const Pair& a) { return {-a.high, -a.low}; }
Pair operator+(const Pair& a, const Pair& b) {
  const Pair s = sum_of(a.high, b.high), t = sum_of(a.low, b.low);
  const Pair u = ordered_sum_of(s.high, s.low + t.high);
  return ordered_sum_of(u.high, u.low + t.low);
}
Pair operator*(const Pair& a, const Pair& b) {
  const Pair p = product_of(a.high, b.high);
  return ordered_sum_of(p.high, p.low + (a.high * b.low + a.low * b.high));
}

// orient3d() in about 100 bits, for points that are coplanar but for their rounding; 2: undecided.
int orient3d_in_pairs(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::array<Pair, 3> u, v, w;
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    u[i] = sum_of(a[i], -d[i]);
    v[i] = sum_of(b[i], -d[i]);
    w[i] = sum_of(c[i], -d[i]);
    largest = std::max({largest, std::abs(u[i].high), std::abs(v[i].high), std::abs(w[i].high)});
  }
  Pair det{0, 0};
  double permanent = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Pair left = v[j] * w[k], right = v[k] * w[j];
    det = det + u[i] * (left + -right);
    permanent += std::abs(u[i].high) * (std::abs(left.high) + std::abs(right.high));
  }
  // With ε = 2⁻⁵³, a product of pairs is off by at most 7 ε² of its size, a sum by 3 ε² of those of
  // its terms (Joldes et al. 2017). Each term of the determinant passes through two products and
  // four sums: 26 ε². The bound, 64 ε², covers higher orders and the rounding of the permanent.
  // Underflow is smaller by far for permanents and factors of this size.
  const double bound = 0x1p-100 * permanent;
  if (!(permanent > 1e-150 && largest < 1e50)) return 2;
  return det.high > bound ? -1 : det.high < -bound ? 1 : 2;
}

}  // namespace

int orient3d_refined(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  for (int i = 0; i < 3; ++i)
    if (a[i] == b[i] && a[i] == c[i] && a[i] == d[i]) return 0;
  if (a == d || b == d || c == d || a == b || b == c || c == a) return 0;
  return orient3d_in_pairs(a, b, c, d);
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int sign = orient3d_refined(a, b, c, d);
  return sign != 2 ? sign : exact.orient3d(a, b, c, d);
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int sign = orient2d_filtered(a, b, c, axis), i = (axis + 1) % 3, j = (axis + 2) % 3;
  if (sign != 2) return sign;
  return exact.orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]});
}

std::pair<int, int> projection_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  int axis = 0;
  (b - a).cross(c - a).cwiseAbs().maxCoeff(&axis);
  int turn = orient2d(a, b, c, axis);
  for (int tries = 0; tries < 2 && turn == 0; ++tries) {
    axis = (axis + 1) % 3;
    turn = orient2d(a, b, c, axis);
  }
  return {axis, turn};
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Filter: each component of the cross product has a rounding error of at most 4 ε times its
  // permanent, ε = 2⁻⁵³: 4.5e-16, below the 5e-16 used.
  const Vec3 u = b - a, v = c - a;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = u[j] * v[k], y = u[k] * v[j], permanent = std::abs(x) + std::abs(y);
    if (permanent > filter_smallest && permanent < filter_largest && std::abs(x - y) > 5e-16 * permanent) return false;
  }
  return exact.collinear(a, b, c);
}

int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return exact.coplanar_side(a, b, c, d);
}

bool share_corners_only(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  int axis = 0;
  (s[1] - s[0]).cross(s[2] - s[0]).cwiseAbs().maxCoeff(&axis);
  // Whether the line through an edge of x has y strictly on its far side, except for shared
  // corners.
  const auto edge_separates = [axis](const Vec3(&x)[3], const Vec3(&y)[3]) {
    const int turn = orient2d_filtered(x[0], x[1], x[2], axis);
    if (turn == 2) return false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = x[k], &b = x[(k + 1) % 3];
      bool beyond = true;
      for (int j = 0; j < 3 && beyond; ++j)
        beyond = y[j] == a || y[j] == b || orient2d_filtered(a, b, y[j], axis) == -turn;
      if (beyond) return true;
    }
    return false;
  };
  return edge_separates(s, t) || edge_separates(t, s);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int sp = orient3d_filtered(a, b, c, p), sq = orient3d_filtered(a, b, c, q);
  if (sp != 2 && sq != 2) {
    if (sp == sq) return false;
    // The end points are strictly on opposite sides, hence abc has an area: the orientations of the
    // line and each edge decide.
    const int s0 = orient3d_filtered(p, q, a, b), s1 = orient3d_filtered(p, q, b, c),
              s2 = orient3d_filtered(p, q, c, a);
    if ((s0 != 2 && s1 != 2 && s0 != s1) || (s1 != 2 && s2 != 2 && s1 != s2) || (s0 != 2 && s2 != 2 && s0 != s2))
      return false;
    if (s0 != 2 && s1 != 2 && s2 != 2) return true;
    const int e0 = orient3d(p, q, a, b), e1 = orient3d(p, q, b, c), e2 = orient3d(p, q, c, a);
    return (e0 >= 0 && e1 >= 0 && e2 >= 0) || (e0 <= 0 && e1 <= 0 && e2 <= 0);
  }
  if (collinear(a, b, c)) {
    const auto [u, v] = as_segment(a, b, c);
    return segments_meet(p, q, u, v);
  }
  return same(p, q) ? exact.on_triangle(a, b, c, p) : exact.segment_meets_triangle(p, q, a, b, c);
}

bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  // Disjoint if all corners of one lie strictly on one side of the plane of the other.
  int sign[2][3];
  for (int k = 0; k < 3; ++k) sign[0][k] = orient3d_filtered(s[0], s[1], s[2], t[k]);
  if (sign[0][0] != 2 && sign[0][0] == sign[0][1] && sign[0][0] == sign[0][2]) return false;
  for (int k = 0; k < 3; ++k) sign[1][k] = orient3d_filtered(t[0], t[1], t[2], s[k]);
  if (sign[1][0] != 2 && sign[1][0] == sign[1][1] && sign[1][0] == sign[1][2]) return false;
  bool decided = true;
  for (const auto& row : sign)
    for (const int x : row) decided = decided && x != 2;
  if (decided) {
    // Both meet the line common to their planes: do the two intervals overlap? With the lone
    // corner of each first and on the positive side, two orientations decide (Guigue, Devillers
    // 2003).
    const auto arrange = [](const Vec3(&x)[3], const int(&of)[3], const Vec3*(&corner)[3]) {
      int lone = of[0] == of[1] ? 2 : of[0] == of[2] ? 1 : 0;
      for (int k = 0; k < 3; ++k) corner[k] = &x[(lone + k) % 3];
      return of[lone] > 0;
    };
    const Vec3 *p[3], *q[3];
    const bool up_s = arrange(s, sign[1], p), up_t = arrange(t, sign[0], q);
    if (!up_s) std::swap(q[1], q[2]);
    if (!up_t) std::swap(p[1], p[2]);
    const int first = orient3d_filtered(*p[0], *p[1], *q[0], *q[1]),
              second = orient3d_filtered(*p[0], *p[2], *q[2], *q[0]);
    if (first == 1 || second == 1) return false;
    if (first == -1 && second == -1) return true;
  }
  const bool flat_s = collinear(s[0], s[1], s[2]), flat_t = collinear(t[0], t[1], t[2]);
  if (flat_s) {
    const auto [u, v] = as_segment(s[0], s[1], s[2]);
    return segment_meets_triangle(u, v, t[0], t[1], t[2]);
  }
  if (flat_t) {
    const auto [u, v] = as_segment(t[0], t[1], t[2]);
    return segment_meets_triangle(u, v, s[0], s[1], s[2]);
  }
  return exact.triangles_meet(s, t);
}

int compare_angle(const Vec3& u, const Vec3& v, const Vec3& zero, const Vec3& a, const Vec3& b) {
  // 0: angle 0; 1: in (0, π); 2: π; 3: in (π, 2π).
  const auto sector = [&](const Vec3& w) {
    const int side = orient3d(u, v, zero, w);
    if (side != 0) return side > 0 ? 1 : 3;
    return coplanar_side(u, v, zero, w) > 0 ? 0 : 2;
  };
  const int qa = sector(a), qb = sector(b);
  if (qa != qb) return qa < qb ? -1 : 1;
  if (qa == 0 || qa == 2) return 0;
  return -orient3d(u, v, a, b);
}

int volume_sign(std::span<const std::array<Vec3, 3>> triangles) {
  if (triangles.empty()) return 0;
  // Volumes of tetrahedra with a common apex on the surface, so that coordinates far from 0 do no
  // harm.
  const Vec3 apex = triangles[0][0];
  double sum = 0, permanent = 0;
  for (const auto& corners : triangles) {
    const Vec3 a = corners[0] - apex, b = corners[1] - apex, c = corners[2] - apex;
    sum += a.dot(b.cross(c));
    const Vec3 u = b.cwiseAbs(), v = c.cwiseAbs();
    permanent += a.cwiseAbs().dot(
        Vec3(u.y() * v.z() + u.z() * v.y(), u.z() * v.x() + u.x() * v.z(), u.x() * v.y() + u.y() * v.x()));
  }
  // Rounding, relative to the permanent, with ε = 2⁻⁵³: 3 ε of the differences, 5 ε of a
  // determinant, n ε of the sum, and as much for the permanent's own sum. 2⁻⁵² (n + 8) bounds all
  // of it.
  const double bound = 0x1p-52 * (double(triangles.size()) + 8) * permanent;
  if (permanent > filter_smallest && permanent < filter_largest && std::abs(sum) > bound) return sum > 0 ? 1 : -1;
  return exact.volume_sign(triangles);
}

}  // namespace geo
