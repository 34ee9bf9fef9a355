#include <gmpxx.h>

#include <bit>
#include <cmath>

#include "crack/points_internal.h"
#include "geometry/predicates.h"

namespace geo::crack {
namespace {

using Number = mpq_class;
using ExactVec = std::array<Number, 3>;

ExactVec to_exact(const Vec3& p) { return {Number(p.x()), Number(p.y()), Number(p.z())}; }
ExactVec minus(const ExactVec& a, const ExactVec& b) {
  return {Number(a[0] - b[0]), Number(a[1] - b[1]), Number(a[2] - b[2])};
}
Number det(const ExactVec& a, const ExactVec& b, const ExactVec& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// The nearest double; of two equally near the one closer to zero.
double nearest(const Number& x) {
  const double inner = x.get_d();  // rounded towards zero
  const Number rest = abs(x - Number(inner));
  if (rest == 0) return inner;
  const double outer = std::nextafter(inner, sgn(x) > 0 ? HUGE_VAL : -HUGE_VAL);
  return abs(Number(outer) - x) < rest ? outer : inner;
}

constexpr double smallest = 1e-250, largest = 1e250;

}  // namespace

struct Points::Exact {
  ExactVec p;
};

Points::Points() = default;
Points::~Points() = default;

Local Points::append(Vec3 p, double error) {
  near_.push_back(p + Vec3::Zero());  // one zero
  error_.push_back(error);
  definition_.push_back(~0u);
  return static_cast<Local>(near_.size() - 1);
}

Local Points::add(Vec3 p) { return append(p, 0); }

Local Points::add_crossing(Vec3 a, Vec3 b, Vec3 p, Vec3 q, Vec3 r) {
  // In extended precision the quotient is good to the last place of a double unless ab is nearly in the plane.
  using Long = long double;
  Long u[3], v[3], wa[3], wb[3];
  for (int i = 0; i < 3; ++i)
    u[i] = Long(q[i]) - p[i], v[i] = Long(r[i]) - p[i], wa[i] = Long(a[i]) - p[i], wb[i] = Long(b[i]) - p[i];
  Long da = 0, db = 0, size_a = 0, size_b = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Long x = u[j] * v[k], y = u[k] * v[j], n = x - y, m = std::abs(x) + std::abs(y);
    da += n * wa[i], db += n * wb[i];
    size_a += m * std::abs(wa[i]), size_b += m * std::abs(wb[i]);
  }
  constexpr Long unit = 0x1p-64L;
  const Long error_a = 12 * unit * size_a, error_b = 12 * unit * size_b, whole = std::abs(da - db);
  const Long t = whole > 0 ? da / (da - db) : 0.5L;
  const Long error_t = whole > 0 ? 2 * (error_a + error_b) / whole + 4 * unit : 1;
  Vec3 x;
  double size = 0, length = 0;
  for (int i = 0; i < 3; ++i) {
    x[i] = static_cast<double>(a[i] + t * (Long(b[i]) - a[i]));
    size = std::max({size, std::abs(a[i]), std::abs(b[i])});
    length = std::max(length, std::abs(b[i] - a[i]));
  }
  const double last = size * 0x1p-53, error = 1.01 * last + 1.01 * static_cast<double>(error_t) * length;
  const Local l = append(x, error);
  definition_[l] = static_cast<std::uint32_t>(definitions_.size());
  definitions_.push_back({l, {a, b, p, q, r}});
  if (!(error <= 8 * last) || !(static_cast<double>(size_a) > smallest) || !(static_cast<double>(size_a) < largest)) round(l);
  return l;
}

Local Points::add_crossing_in_plane(Local a, Local b, Local c, Local d, int axis) {
  const auto &pa = exact(a).p, &pb = exact(b).p, &pc = exact(c).p, &pd = exact(d).p;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto turn = [&](const ExactVec& p, const ExactVec& q, const ExactVec& r) {
    return Number((q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]));
  };
  const Number ta = turn(pc, pd, pa), tb = turn(pc, pd, pb), t = ta / (ta - tb);
  auto value = std::make_unique<Exact>();
  for (int k = 0; k < 3; ++k) value->p[k] = pa[k] + t * (pb[k] - pa[k]);
  const Local l = append(Vec3::Zero(), 0);
  if (exact_.size() <= l) exact_.resize(l + 1);
  exact_[l] = std::move(value);
  definition_[l] = ~1u;
  round(l);
  return l;
}

void Points::round(Local l) {
  const auto& e = exact(l).p;
  double error = 0;
  for (int i = 0; i < 3; ++i) {
    near_[l][i] = nearest(e[i]) + 0.0;
    if (Number(near_[l][i]) != e[i]) error = std::max(error, std::abs(near_[l][i]) * 0x1p-52 + 0x1p-1074);
  }
  error_[l] = error;
}

const Points::Exact& Points::exact(Local l) const {
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
  const Number da = det(u, v, minus(a, p)), db = det(u, v, minus(b, p)), t = da / (da - db);
  for (int k = 0; k < 3; ++k) slot->p[k] = a[k] + t * (b[k] - a[k]);
  return *slot;
}

int Points::orient3d(Local a, Local b, Local c, Local d) const {
  const Vec3 &pd = near_[d];
  const Vec3 u = near_[a] - pd, v = near_[b] - pd, w = near_[c] - pd;
  const double error = std::max({error_[a], error_[b], error_[c]}) + error_[d];
  const double x = v.y() * w.z(), x2 = v.z() * w.y(), y = v.z() * w.x(), y2 = v.x() * w.z(), z = v.x() * w.y(), z2 = v.y() * w.x();
  const double value = u.x() * (x - x2) + u.y() * (y - y2) + u.z() * (z - z2);
  const double permanent = std::abs(u.x()) * (std::abs(x) + std::abs(x2)) + std::abs(u.y()) * (std::abs(y) + std::abs(y2)) +
                           std::abs(u.z()) * (std::abs(z) + std::abs(z2));
  double bound = 7.9e-16 * permanent;
  if (error > 0) {
    // The determinant is linear in each of its nine entries, and each is off by `error` at most.
    const double m = std::max({u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff(), w.cwiseAbs().maxCoeff()});
    if (!(error < 1e-3 * m)) bound = largest;
    bound += 20 * m * m * error;
  }
  // The determinant of a−d, b−d, c−d is that of the contract with its sign turned.
  if (permanent > smallest && permanent < largest && std::abs(value) > bound) return value > 0 ? -1 : 1;
  if (error == 0) return geo::orient3d(near_[a], near_[b], near_[c], near_[d]);
  const ExactVec &ea = exact(a).p, eb = exact(b).p, ec = exact(c).p, ed = exact(d).p;
  return sgn(det(minus(eb, ea), minus(ec, ea), minus(ed, ea)));
}

int Points::orient2d(Local a, Local b, Local c, int axis) const {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const Vec3 &pa = near_[a], &pb = near_[b], &pc = near_[c];
  const double ux = pa[i] - pc[i], uy = pa[j] - pc[j], vx = pb[i] - pc[i], vy = pb[j] - pc[j];
  const double left = ux * vy, right = uy * vx, value = left - right;
  const double error = std::max(error_[a], error_[b]) + error_[c], terms = std::abs(left) + std::abs(right);
  double bound = 3.4e-16 * terms;
  if (error > 0) bound += error * 1.01 * (std::abs(ux) + std::abs(uy) + std::abs(vx) + std::abs(vy) + 2 * error);
  if (terms > smallest && terms < largest && std::abs(value) > bound) return value > 0 ? 1 : -1;
  const ExactVec &ea = exact(a).p, &eb = exact(b).p, &ec = exact(c).p;
  return sgn(Number((ea[i] - ec[i]) * (eb[j] - ec[j]) - (ea[j] - ec[j]) * (eb[i] - ec[i])));
}

int Points::compare(Local a, Local b, int axis) const {
  const double difference = near_[a][axis] - near_[b][axis], error = error_[a] + error_[b];
  if (std::abs(difference) > 1.01 * error) return difference > 0 ? 1 : -1;
  if (error == 0) return difference > 0 ? 1 : difference < 0 ? -1 : 0;
  return cmp(exact(a).p[axis], exact(b).p[axis]);
}

bool Points::same_place(Local a, Local b) const {
  if (((near_[a] - near_[b]).cwiseAbs().array() > 1.01 * (error_[a] + error_[b])).any()) return false;
  if (error_[a] == 0 && error_[b] == 0) return true;
  return exact(a).p == exact(b).p;
}

std::uint64_t Points::hash(Local l) const {
  Vec3 p = near_[l];
  if (error_[l] > 0)
    for (int i = 0; i < 3; ++i) p[i] = nearest(exact(l).p[i]);
  std::uint64_t h = 1469598103934665603ull;
  for (int i = 0; i < 3; ++i) {
    h = (h ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 1099511628211ull;  // + 0.0: one zero
    h ^= h >> 29;
  }
  return h;
}

}  // namespace geo::crack
