// Sums and products have 128 bits, of which a result keeps the first 64; a lost bit makes the last
// of the 128 one ("sticky"), so that rounding sees it.
#include "crack/extended.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace geo::crack {
namespace {

constexpr std::uint64_t top_bit = std::uint64_t(1) << 63;

}  // namespace

SoftExtended::SoftExtended(double x) {
  if (x == 0) return;
  int power = 0;
  const double fraction = std::frexp(std::abs(x), &power);  // in [½, 1)
  m_ = static_cast<std::uint64_t>(std::ldexp(fraction, 53)) << 11;
  e_ = power - 64;
  negative_ = x < 0;
}

SoftExtended::operator double() const {
  if (m_ == 0) return 0;
  // Bits before the last one that a double of this size has; fewer than 53 below the normal ones.
  constexpr int double_bits = 53, last_bit = -1074;
  const int kept = std::min(double_bits, e_ + 64 - last_bit), dropped = 64 - kept;
  if (kept < 0) return negative_ ? -0.0 : 0.0;
  std::uint64_t whole = kept == 0 ? 0 : m_ >> dropped;
  const std::uint64_t rest = kept == 0 ? m_ : m_ << kept;  // the dropped bits, from the top
  if (rest > top_bit || (rest == top_bit && (whole & 1) != 0)) ++whole;
  const double value = std::ldexp(static_cast<double>(whole), e_ + dropped);
  return negative_ ? -value : value;
}

// The number (high · 2⁶⁴ + low) · 2^e.
SoftExtended SoftExtended::rounded(bool negative, std::uint64_t high, std::uint64_t low, std::int32_t e) {
  if (high == 0) {
    if (low == 0) return {};
    high = std::exchange(low, 0);
    e -= 64;
  }
  if (const int shift = std::countl_zero(high); shift > 0) {
    high = high << shift | low >> (64 - shift);
    low <<= shift;
    e -= shift;
  }
  if (low > top_bit || (low == top_bit && (high & 1) != 0)) {
    if (++high == 0) return {negative, top_bit, e + 65};
  }
  return {negative, high, e + 64};
}

SoftExtended operator+(const SoftExtended& a, const SoftExtended& b) {
  if (a.m_ == 0) return b;
  if (b.m_ == 0) return a;
  const bool ordered = a.e_ != b.e_ ? a.e_ > b.e_ : a.m_ >= b.m_;
  const SoftExtended &large = ordered ? a : b, &small = ordered ? b : a;
  const std::int64_t shift = std::int64_t(large.e_) - small.e_;
  std::uint64_t high = 0, low = 1;  // of the small one; 1: sticky
  if (shift == 0) {
    high = small.m_;
    low = 0;
  } else if (shift < 64) {
    high = small.m_ >> shift;
    low = small.m_ << (64 - shift);
  } else if (shift == 64) {
    low = small.m_;
  } else if (shift < 128) {
    low = small.m_ >> (shift - 64) | std::uint64_t(small.m_ << (128 - shift) != 0);
  }
  if (large.negative_ != small.negative_)
    return SoftExtended::rounded(large.negative_, large.m_ - high - std::uint64_t(low != 0), 0 - low, large.e_ - 64);
  const std::uint64_t sum = large.m_ + high;
  if (sum >= large.m_) return SoftExtended::rounded(large.negative_, sum, low, large.e_ - 64);
  // A carry: one bit more.
  const std::uint64_t shifted = low >> 1 | (low & 1) | sum << 63;
  return SoftExtended::rounded(large.negative_, sum >> 1 | top_bit, shifted, large.e_ - 63);
}

SoftExtended operator*(const SoftExtended& a, const SoftExtended& b) {
  if (a.m_ == 0 || b.m_ == 0) return {};
  constexpr std::uint64_t half = 0xffffffff;
  const std::uint64_t a1 = a.m_ >> 32, a0 = a.m_ & half, b1 = b.m_ >> 32, b0 = b.m_ & half;
  const std::uint64_t inner = a0 * b0, cross = a1 * b0 + (inner >> 32), other = a0 * b1 + (cross & half);
  const std::uint64_t high = a1 * b1 + (cross >> 32) + (other >> 32), low = other << 32 | (inner & half);
  return SoftExtended::rounded(a.negative_ != b.negative_, high, low, a.e_ + b.e_);
}

SoftExtended operator/(const SoftExtended& a, const SoftExtended& b) {
  if (a.m_ == 0) return {};
  // One bit of the quotient after the other, until it has 64 with the highest one set.
  const bool smaller = a.m_ < b.m_;
  const int bits = smaller ? 64 : 63;
  std::uint64_t quotient = smaller ? 0 : 1, rest = smaller ? a.m_ : a.m_ - b.m_;
  for (int bit = 0; bit < bits; ++bit) {
    const bool carry = (rest & top_bit) != 0;
    rest <<= 1;
    quotient <<= 1;
    if (carry || rest >= b.m_) {
      rest -= b.m_;
      quotient |= 1;
    }
  }
  // The rest against half of the divisor takes the place of the bits that follow.
  const std::uint64_t left = b.m_ - rest;
  const std::uint64_t low = rest == 0 ? 0 : rest < left ? 1 : rest == left ? top_bit : top_bit | 1;
  return SoftExtended::rounded(a.negative_ != b.negative_, quotient, low, a.e_ - b.e_ - bits - 64);
}

}  // namespace geo::crack
