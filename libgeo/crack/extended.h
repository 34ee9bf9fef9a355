// Extended: floating-point numbers with 64 bits, as x86's long double. Other machines have long
// doubles of other widths; there SoftExtended computes the same values with integers.
#pragma once

#include <cfloat>
#include <cstdint>

namespace geo::crack {

/// A number ± m · 2^e with 64 bits. Each operation rounds to the nearest, ties to even. The
/// exponent has 32 bits: finite doubles and short products of them neither overflow nor underflow.
/// There is one zero.
class SoftExtended {
 public:
  /// Zero.
  SoftExtended() = default;
  /// A finite double, exactly.
  SoftExtended(double x);
  /// The nearest double, ties to even.
  explicit operator double() const;

  /// The difference, rounded.
  friend SoftExtended operator-(const SoftExtended& a, const SoftExtended& b) { return a + -b; }
  /// Sum, product and quotient, rounded; a divisor is not zero.
  friend SoftExtended operator+(const SoftExtended& a, const SoftExtended& b);
  friend SoftExtended operator*(const SoftExtended& a, const SoftExtended& b);
  friend SoftExtended operator/(const SoftExtended& a, const SoftExtended& b);
  /// The number of the other sign.
  SoftExtended operator-() const { return {!negative_, m_, e_}; }
  /// Adds a number.
  SoftExtended& operator+=(const SoftExtended& b) { return *this = *this + b; }
  /// Whether a is larger than b.
  friend bool operator>(const SoftExtended& a, const SoftExtended& b) {
    const SoftExtended difference = a - b;
    return difference.m_ != 0 && !difference.negative_;
  }
  /// The absolute value.
  SoftExtended magnitude() const { return {false, m_, e_}; }

 private:
  SoftExtended(bool negative, std::uint64_t m, std::int32_t e) : m_(m), e_(e), negative_(negative) {}
  static SoftExtended rounded(bool negative, std::uint64_t high, std::uint64_t low, std::int32_t e);

  std::uint64_t m_ = 0;  // 0, or with its highest bit set
  std::int32_t e_ = 0;
  bool negative_ = false;
};

/// The absolute value.
inline SoftExtended abs(const SoftExtended& a) { return a.magnitude(); }

#if LDBL_MANT_DIG == 64
using Extended = long double;
#else
using Extended = SoftExtended;
#endif

}  // namespace geo::crack
