// Floating-point filters with error bounds, and whole numbers of any size where they fail: exact
// numbers are m · 2^e with whole m, exact points homogeneous. ab crosses a plane at (b d_a − a d_b)
// / (d_a − d_b); d_a and d_b are the signed distances of a and b, times |normal|.
#include "crack/points.h"

#include <bit>
#include <cmath>

#include "base/bit_cast.h"
#include "crack/extended.h"
#include "crack/whole_number.h"
#include "geometry/predicates.h"

namespace geo::crack {
namespace {

// m · 2^e: sums and products of doubles without rounding and without fractions.
struct Dyadic {
  Whole m = 0;
  long e = 0;
  Dyadic() = default;
  explicit Dyadic(double x) {
    if (x == 0) return;
    int power = 0;
    const auto whole = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &power), 53));
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(whole));  // many in numbers that were floats
    m = whole >> zeros;
    e = power - 53 + zeros;
  }
};
Dyadic operator*(const Dyadic& a, const Dyadic& b) {
  Dyadic c;
  c.m = a.m * b.m;
  c.e = a.e + b.e;
  return c;
}
Dyadic sum(const Dyadic& a, const Dyadic& b, bool minus) {
  if (sign_of(b.m) == 0) return a;
  Dyadic c;
  c.e = std::min(a.e, b.e);
  if (sign_of(a.m) == 0) c.e = b.e;
  const Whole x = sign_of(a.m) == 0 ? Whole(0) : shifted(a.m, a.e - c.e);
  const Whole y = shifted(b.m, b.e - c.e);
  if (minus)
    c.m = x - y;
  else
    c.m = x + y;
  return c;
}
Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, false); }
Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, true); }
int sign(const Dyadic& a) { return sign_of(a.m); }

using ExactVec = std::array<Dyadic, 3>;

ExactVec to_exact(const Vec3& p) { return {Dyadic(p.x()), Dyadic(p.y()), Dyadic(p.z())}; }
ExactVec minus(const ExactVec& a, const ExactVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Dyadic det(const ExactVec& a, const ExactVec& b, const ExactVec& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// A quotient as a double.
struct Rounded {
  double value;  // the nearest one; of two equally near the one closer to zero
  bool exact;
};

// a / b for b > 0. One division gives 62 or 63 bits and whether there are more. Below the smallest
// normal number a double has fewer than 53 of them.
Rounded round_quotient(const Dyadic& a, const Dyadic& b) {
  if (sign(a) == 0) return {0.0, true};
  const long shift = 62 - bit_length(a.m) + bit_length(b.m), exponent = a.e - b.e - shift;
  const Whole up = sign(a) > 0 ? a.m : Whole(-a.m);
  Whole whole, rest;
  divide(shifted(up, std::max(shift, 0l)), shifted(b.m, std::max(-shift, 0l)), whole, rest);
  const std::uint64_t q = small(whole);
  constexpr long last_bit = -1074;  // the smallest double is 2^last_bit
  const long dropped = std::max<long>(std::bit_width(q) - 53, last_bit - exponent);
  if (dropped > 63) return {0.0, false};  // q < 2⁶³: less than half of the smallest double
  const std::uint64_t low = q & ((std::uint64_t(1) << dropped) - 1), half = std::uint64_t(1) << (dropped - 1);
  const bool more = sign_of(rest) != 0, outwards = low > half || (low == half && more);
  const double value = std::ldexp(static_cast<double>((q >> dropped) + outwards), static_cast<int>(exponent + dropped));
  return {sign(a) > 0 ? value : -value, low == 0 && !more};
}

// Filters hold where products neither underflow nor overflow; other values are computed exactly.
constexpr double smallest = 1e-250, largest = 1e250;

}  // namespace

// Homogeneous: p / w, w > 0.
struct Points::Exact {
  ExactVec p;
  Dyadic w{1.0};

  /// The difference to another point, times both denominators.
  ExactVec from(const Exact& o) const {
    ExactVec d;
    for (int i = 0; i < 3; ++i) d[i] = p[i] * o.w - o.p[i] * w;
    return d;
  }
  void keep_positive() {
    if (sign(w) > 0) return;
    w.m = Whole(-w.m);
    for (auto& x : p) x.m = Whole(-x.m);
  }
};

Points::Points() = default;
Points::~Points() = default;

PointIndex Points::append(Vec3 p, double error) {
  near_.push_back(p + Vec3::Zero());  // −0 becomes 0
  error_.push_back(error);
  definition_.push_back(~0u);
  return static_cast<PointIndex>(near_.size() - 1);
}

PointIndex Points::add(Vec3 p) { return append(p, 0); }

PointIndex Points::add_crossing(Vec3 a, Vec3 b, Vec3 p, Vec3 q, Vec3 r) {
  // In extended precision the quotient is accurate to an ulp of a double, unless ab is nearly in
  // the plane.
  using Long = Extended;
  using std::abs;
  Long u[3], v[3], wa[3], wb[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = Long(q[i]) - p[i];
    v[i] = Long(r[i]) - p[i];
    wa[i] = Long(a[i]) - p[i];
    wb[i] = Long(b[i]) - p[i];
  }
  Long da = 0, db = 0, size_a = 0, size_b = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Long x = u[j] * v[k], y = u[k] * v[j], n = x - y, m = abs(x) + abs(y);
    da += n * wa[i];
    db += n * wb[i];
    size_a += m * abs(wa[i]);
    size_b += m * abs(wb[i]);
  }
  // t = d_a / (d_a − d_b), d_x = (q − p) × (r − p) · (x − p). Each term of d passes through at most
  // 12 roundings of 2⁻⁶⁴; the error of t follows from those of d_a and d_b.
  const Long unit = 0x1p-64;
  const Long error_a = 12 * unit * size_a, error_b = 12 * unit * size_b, whole = abs(da - db);
  const Long t = whole > 0 ? da / (da - db) : Long(0.5);
  const Long error_t = whole > 0 ? 2 * (error_a + error_b) / whole + 4 * unit : Long(1);
  Vec3 x;
  double size = 0, length = 0;
  for (int i = 0; i < 3; ++i) {
    // In a plane along the axes as exactly as its corners are, so that flat skin stays flat.
    x[i] = p[i] == q[i] && q[i] == r[i] ? p[i] : static_cast<double>(a[i] + t * (Long(b[i]) - a[i]));
    size = std::max({size, std::abs(a[i]), std::abs(b[i])});
    length = std::max(length, std::abs(b[i] - a[i]));
  }
  // Rounding to double, and the error of t along ab; 1.01 covers the roundings of the bound itself.
  const double half_ulp = size * 0x1p-53, error = 1.01 * half_ulp + 1.01 * static_cast<double>(error_t) * length;
  const PointIndex l = append(x, error);
  definition_[l] = static_cast<std::uint32_t>(definitions_.size());
  definitions_.push_back({l, {a, b, p, q, r}});
  // A loose bound would defeat the filters: the point is then rounded from its exact coordinates.
  if (!(error <= 8 * half_ulp) || !(static_cast<double>(size_a) > smallest) || !(static_cast<double>(size_a) < largest))
    round(l);
  return l;
}

PointIndex Points::add_crossing_in_plane(PointIndex a, PointIndex b, PointIndex c, PointIndex d, int axis) {
  const Exact &pa = exact(a), &pb = exact(b), &pc = exact(c), &pd = exact(d);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto turn = [&](const Exact& p, const Exact& q, const Exact& r) {
    return det({p.p[i], p.p[j], p.w}, {q.p[i], q.p[j], q.w}, {r.p[i], r.p[j], r.w});
  };
  const Dyadic ta = turn(pc, pd, pa) * pb.w, tb = turn(pc, pd, pb) * pa.w, whole = ta - tb;
  auto value = std::make_unique<Exact>();
  for (int k = 0; k < 3; ++k) value->p[k] = pb.p[k] * pa.w * ta - pa.p[k] * pb.w * tb;
  value->w = pa.w * pb.w * whole;
  value->keep_positive();
  const PointIndex l = append(Vec3::Zero(), 0);
  if (exact_.size() <= l) exact_.resize(l + 1);
  exact_[l] = std::move(value);
  round(l);
  return l;
}

void Points::round(PointIndex l) {
  const Exact& e = exact(l);
  double error = 0;
  for (int i = 0; i < 3; ++i) {
    const auto [value, whole] = round_quotient(e.p[i], e.w);
    near_[l][i] = value + 0.0;
    if (!whole) error = std::max(error, std::abs(value) * 0x1p-52 + 0x1p-1074);
  }
  error_[l] = error;
}

const Points::Exact& Points::exact(PointIndex l) const {
  if (exact_.size() <= l) exact_.resize(near_.size());
  auto& slot = exact_[l];
  if (slot) return *slot;
  slot = std::make_unique<Exact>();
  if (definition_[l] == ~0u) {
    slot->p = to_exact(near_[l]);
    return *slot;
  }
  const auto& of = definitions_[definition_[l]].of;
  const ExactVec a = to_exact(of[0]), b = to_exact(of[1]), p = to_exact(of[2]);
  const ExactVec u = minus(to_exact(of[3]), p), v = minus(to_exact(of[4]), p);
  const Dyadic da = det(u, v, minus(a, p)), db = det(u, v, minus(b, p));
  slot->w = da - db;
  for (int k = 0; k < 3; ++k) slot->p[k] = b[k] * da - a[k] * db;
  slot->keep_positive();
  return *slot;
}

int Points::orient3d(PointIndex a, PointIndex b, PointIndex c, PointIndex d) const {
  const Vec3& pd = near_[d];
  const Vec3 u = near_[a] - pd, v = near_[b] - pd, w = near_[c] - pd;
  const double error = std::max({error_[a], error_[b], error_[c]}) + error_[d];
  const double x = v.y() * w.z(), x2 = v.z() * w.y(), y = v.z() * w.x(), y2 = v.x() * w.z(), z = v.x() * w.y(),
               z2 = v.y() * w.x();
  const double value = u.x() * (x - x2) + u.y() * (y - y2) + u.z() * (z - z2);
  const double permanent = std::abs(u.x()) * (std::abs(x) + std::abs(x2)) +
                           std::abs(u.y()) * (std::abs(y) + std::abs(y2)) +
                           std::abs(u.z()) * (std::abs(z) + std::abs(z2));
  // Shewchuk's static bound for orient3d (1997): (7 + 56 ε) ε · permanent, ε = 2⁻⁵³.
  double bound = 7.9e-16 * permanent;
  if (error > 0) {
    // The determinant is linear in each of its nine entries, each off by `error` at most. Minors
    // are at most 2 m²: 18 m² · error in all, and 20 covers higher orders if error < m / 1000.
    const double m = std::max({u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff(), w.cwiseAbs().maxCoeff()});
    if (!(error < 1e-3 * m)) bound = largest;
    bound += 20 * m * m * error;
  }
  // The determinant of a−d, b−d, c−d is that of the contract with its sign turned.
  if (permanent > smallest && permanent < largest && std::abs(value) > bound) return value > 0 ? -1 : 1;
  if (error == 0) return geo::orient3d(near_[a], near_[b], near_[c], near_[d]);
  const Exact& from = exact(a);
  return sign(det(exact(b).from(from), exact(c).from(from), exact(d).from(from)));
}

int Points::orient2d(PointIndex a, PointIndex b, PointIndex c, int axis) const {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const Vec3 &pa = near_[a], &pb = near_[b], &pc = near_[c];
  const double ux = pa[i] - pc[i], uy = pa[j] - pc[j], vx = pb[i] - pc[i], vy = pb[j] - pc[j];
  const double left = ux * vy, right = uy * vx, value = left - right;
  const double error = std::max(error_[a], error_[b]) + error_[c], terms = std::abs(left) + std::abs(right);
  // Shewchuk's static bound for orient2d (1997): (3 + 16 ε) ε · terms, ε = 2⁻⁵³.
  double bound = 3.4e-16 * terms;
  if (error > 0) bound += error * 1.01 * (std::abs(ux) + std::abs(uy) + std::abs(vx) + std::abs(vy) + 2 * error);
  if (terms > smallest && terms < largest && std::abs(value) > bound) return value > 0 ? 1 : -1;
  const ExactVec u = exact(a).from(exact(c)), v = exact(b).from(exact(c));
  return sign(u[i] * v[j] - u[j] * v[i]);
}

int Points::compare(PointIndex a, PointIndex b, int axis) const {
  const double difference = near_[a][axis] - near_[b][axis], error = error_[a] + error_[b];
  if (std::abs(difference) > 1.01 * error) return difference > 0 ? 1 : -1;
  if (error == 0) return difference > 0 ? 1 : difference < 0 ? -1 : 0;
  const Exact &ea = exact(a), &eb = exact(b);
  return sign(ea.p[axis] * eb.w - eb.p[axis] * ea.w);
}

bool Points::coincide(PointIndex a, PointIndex b) const {
  if (((near_[a] - near_[b]).cwiseAbs().array() > 1.01 * (error_[a] + error_[b])).any()) return false;
  if (error_[a] == 0 && error_[b] == 0) return true;
  const ExactVec d = exact(a).from(exact(b));
  return sign(d[0]) == 0 && sign(d[1]) == 0 && sign(d[2]) == 0;
}

std::uint64_t Points::hash(PointIndex l) const {
  Vec3 p = near_[l];
  if (error_[l] > 0)
    for (int i = 0; i < 3; ++i) p[i] = round_quotient(exact(l).p[i], exact(l).w).value;
  return hash_of(p);
}

std::uint64_t hash_of(const Vec3& p) {
  std::uint64_t h = 1469598103934665603ull;
  for (int i = 0; i < 3; ++i) {
    h = (h ^ bit_cast<std::uint64_t>(p[i] + 0.0)) * 1099511628211ull;  // + 0.0: −0 becomes 0
    h ^= h >> 29;
  }
  return h;
}

}  // namespace geo::crack
