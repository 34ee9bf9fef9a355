// Exact sums and products of doubles as expansions: sums of doubles that do not overlap, in
// ascending order of magnitude (Shewchuk, Adaptive precision floating-point arithmetic and fast
// robust geometric predicates, 1997).
//
// They are exact while no product underflows or overflows, and where rounding is to the nearest.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace geo {

/// A sum of at most `most` doubles, all but zero itself without zeros.
template <std::size_t most>
class Expansion {
 public:
  /// Zero.
  Expansion() = default;
  /// The difference a − b, exactly.
  static Expansion difference(double a, double b) requires(most >= 2) {
    Expansion result;
    const double x = a - b, b_virtual = a - x, a_virtual = x + b_virtual;
    result.append((a - a_virtual) + (b_virtual - b));
    result.append(x);
    return result;
  }

  /// Appends a part that is larger than all others and does not overlap them; zeros are left out.
  void append(double part) {
    if (part != 0) part_[size_++] = part;
  }
  /// Number of parts.
  std::size_t size() const { return size_; }
  /// The i-th part.
  double operator[](std::size_t i) const { return part_[i]; }
  /// −1, 0 or 1: that of the largest part.
  int sign() const { return size_ == 0 ? 0 : part_[size_ - 1] > 0 ? 1 : -1; }
  /// The number of the other sign.
  Expansion operator-() const {
    Expansion result = *this;
    for (std::size_t i = 0; i < size_; ++i) result.part_[i] = -part_[i];
    return result;
  }

 private:
  std::array<double, most> part_;
  std::size_t size_ = 0;
};

/// A double and what its rounding lost.
struct Rounding {
  double value, lost;
};
/// a + b.
inline Rounding exact_sum(double a, double b) {
  const double x = a + b, b_virtual = x - a, a_virtual = x - b_virtual;
  return {x, (a - a_virtual) + (b - b_virtual)};
}
/// a · b, by halves of 26 bits (Dekker).
inline Rounding exact_product(double a, double b) {
  constexpr double splitter = 0x1p27 + 1;
  const double x = a * b;
  const double big_a = splitter * a, high_a = big_a - (big_a - a), low_a = a - high_a;
  const double big_b = splitter * b, high_b = big_b - (big_b - b), low_b = b - high_b;
  return {x, low_a * low_b - (((x - high_a * high_b) - low_a * high_b) - high_a * low_b)};
}

/// The sum of two expansions: their parts in order of magnitude, added one after the other.
template <std::size_t m, std::size_t n>
Expansion<m + n> operator+(const Expansion<m>& a, const Expansion<n>& b) {
  Expansion<m + n> result;
  std::size_t i = 0, j = 0;
  const auto next = [&] {
    const bool from_a = j == b.size() || (i < a.size() && std::abs(a[i]) < std::abs(b[j]));
    return from_a ? a[i++] : b[j++];
  };
  if (a.size() + b.size() == 0) return result;
  double sum = next();
  while (i < a.size() || j < b.size()) {
    const Rounding r = exact_sum(sum, next());
    result.append(r.lost);
    sum = r.value;
  }
  result.append(sum);
  return result;
}

/// The difference of two expansions.
template <std::size_t m, std::size_t n>
Expansion<m + n> operator-(const Expansion<m>& a, const Expansion<n>& b) {
  return a + -b;
}

/// The product with a double.
template <std::size_t m>
Expansion<2 * m> scaled(const Expansion<m>& a, double by) {
  Expansion<2 * m> result;
  if (a.size() == 0 || by == 0) return result;
  Rounding product = exact_product(a[0], by);
  result.append(product.lost);
  double sum = product.value;
  for (std::size_t i = 1; i < a.size(); ++i) {
    product = exact_product(a[i], by);
    const Rounding low = exact_sum(sum, product.lost);
    result.append(low.lost);
    const Rounding high = exact_sum(product.value, low.value);
    result.append(high.lost);
    sum = high.value;
  }
  result.append(sum);
  return result;
}

/// The product with a difference.
template <std::size_t m>
Expansion<4 * m> operator*(const Expansion<m>& a, const Expansion<2>& b) {
  const double low = b.size() == 2 ? b[0] : 0, high = b.size() == 0 ? 0 : b[b.size() - 1];
  return scaled(a, low) + scaled(a, high);
}

}  // namespace geo
