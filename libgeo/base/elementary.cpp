// Arguments are reduced to a small range, where Taylor series are short. Constants are sums of
// parts with so few bits that their products with small whole numbers are exact.
#include "base/elementary.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace geo {
namespace {

// A number as a sum of two.
struct Parts {
  double high, low;
};
// a + b, exact for |a| ≥ |b| by Dekker's method.
Parts ordered_sum_of(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
// a + b, exact (Knuth).
Parts sum_of(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}
// a · b, exact, by Dekker's method.
Parts product_of(double a, double b) {
  constexpr double splitter = 0x1p27 + 1;
  const double p = a * b;
  const double x = splitter * a, ah = x - (x - a), al = a - ah;
  const double y = splitter * b, bh = y - (y - b), bl = b - bh;
  return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

// Coefficients of a series, from the highest power down.
template <std::size_t n>
double polynomial(const std::array<double, n>& c, double x) {
  double sum = c[0];
  for (std::size_t k = 1; k < n; ++k) sum = c[k] + x * sum;
  return sum;
}

// Coefficients ±1 / (2k + first)! from k = n − 1 down to 0, with signs in turn, the last one
// negative.
template <std::size_t n>
constexpr std::array<double, n> alternating_factorials(int first) {
  std::array<double, n> c{};
  double factorial = 1;
  for (int k = 2; k <= first; ++k) factorial *= k;
  for (std::size_t k = 0; k < n; ++k) {
    c[n - 1 - k] = (k % 2 ? 1 : -1) / factorial;
    const double next = first + 2.0 * double(k) + 1;
    factorial *= next * (next + 1);
  }
  return c;
}

constexpr double farthest = 0x1p20;  // argument whose quadrant, times the parts of π/2, is exact

// x minus the nearest multiple of π/2, and the number of quarter turns, of |x| < farthest.
struct Reduced {
  Parts rest;
  int quarter;
};
Reduced reduced(double x) {
  constexpr double first = 0x1.921fb544p+0, second = 0x1.0b4611a6p-34, third = 0x1.3198a2e037073p-69;  // π/2
  const double n = std::nearbyint(x * std::numbers::inv_pi * 2);
  const Parts a = sum_of(x - n * first, -n * second), b = ordered_sum_of(a.high, a.low - n * third);
  return {b, static_cast<int>(static_cast<long long>(n) & 3)};
}

double sine_near_zero(const Parts& r) {
  static constexpr auto series = alternating_factorials<9>(3);  // to r¹⁹
  const double z = r.high * r.high;
  return r.high + (r.low * (1 - 0.5 * z) + r.high * (z * polynomial(series, z)));
}

double cosine_near_zero(const Parts& r) {
  static constexpr auto series = alternating_factorials<9>(4);  // to r²⁰, with the other sign
  const Parts z = product_of(r.high, r.high), one = ordered_sum_of(1, -0.5 * z.high);
  return one.high + (one.low - (0.5 * z.low + r.high * r.low + z.high * z.high * polynomial(series, z.high)));
}

double quarter_turned(const Reduced& of, int by) {
  const int quarter = (of.quarter + by) & 3;
  const double value = quarter % 2 ? cosine_near_zero(of.rest) : sine_near_zero(of.rest);
  return quarter < 2 ? value : -value;
}

// The arc tangent of t from 0 to 1: that of a multiple c of a quarter, and of (t − c) / (1 + t c).
double arc_tangent(double t) {
  constexpr double of_quarters[] = {0, 0x1.f5b75f92c80ddp-3, 0x1.dac670561bb4fp-2, 0x1.4978fa3269ee1p-1,
                                    0x1.921fb54442d18p-1};
  static constexpr std::array<double, 10> series = [] {
    std::array<double, 10> c{};
    for (int k = 0; k < 10; ++k) c[std::size_t(9 - k)] = (k % 2 ? 1.0 : -1.0) / (2 * k + 3);
    return c;
  }();
  const double quarters = std::nearbyint(4 * t), c = 0.25 * quarters, s = (t - c) / (1 + t * c), z = s * s;
  return of_quarters[static_cast<std::size_t>(quarters)] + (s + s * (z * polynomial(series, z)));
}

constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;

}  // namespace

double sine(double x) { return std::abs(x) < farthest ? quarter_turned(reduced(x), 0) : std::sin(x); }
double cosine(double x) { return std::abs(x) < farthest ? quarter_turned(reduced(x), 1) : std::cos(x); }

double angle_of(double y, double x) {
  const double a = std::abs(x), b = std::abs(y);
  if (a == 0 && b == 0) return 0;
  double angle = b <= a ? arc_tangent(b / a) : std::numbers::pi / 2 - arc_tangent(a / b);
  if (x < 0) angle = std::numbers::pi - angle;
  return y < 0 ? -angle : angle;
}

double arc_cosine(double x) { return 2 * angle_of(std::sqrt(1 - x), std::sqrt(1 + x)); }

double exponential(double x) {
  if (!(std::abs(x) < 700)) return std::exp(x);  // beyond the range, or near it, where digits are lost
  static constexpr std::array<double, 14> series = [] {
    std::array<double, 14> c{};
    double factorial = 1;
    for (int k = 0; k < 14; ++k) {
      if (k > 0) factorial *= k;
      c[std::size_t(13 - k)] = 1 / factorial;
    }
    return c;
  }();
  const double n = std::nearbyint(x * std::numbers::log2e), r = (x - n * ln2_high) - n * ln2_low;
  return std::ldexp(polynomial(series, r), static_cast<int>(n));
}

double logarithm(double x) {
  if (!(x > 0) || !std::isfinite(x)) return std::log(x);
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < std::numbers::sqrt2 / 2) {
    m *= 2;
    --exponent;
  }
  // ln m = 2 artanh s, s = (m − 1) / (m + 1), |s| < 0.172
  static constexpr std::array<double, 10> series = [] {
    std::array<double, 10> c{};
    for (int k = 0; k < 10; ++k) c[std::size_t(9 - k)] = 2.0 / (2 * k + 3);
    return c;
  }();
  const double s = (m - 1) / (m + 1), z = s * s;
  return exponent * ln2_high + (2 * s + (s * (z * polynomial(series, z)) + exponent * ln2_low));
}

double cube_root(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  const int third = exponent >= 0 ? exponent / 3 : -((2 - exponent) / 3);
  m = std::ldexp(m, exponent - 3 * third);  // |m| from ½ to 4
  // The C library's root is good for some ulps. One step of Newton's method follows, with an exact
  // residual.
  const double y = std::cbrt(m);
  const Parts square = product_of(y, y), cube = product_of(square.high, y);
  const double residual = ((m - cube.high) - cube.low) - square.low * y;
  return std::ldexp(y + residual / (3 * square.high), third);
}

}  // namespace geo
