// The resolution of a model: computed coordinates near zero carry noise that doubles resolve there
// and nowhere else in the model. Exact predicates would see it.
#pragma once

#include <cmath>

#include "kerf/vec.h"

namespace geo {

/// Coordinates that are multiples of the ulp of a model's size. Coordinates as large as the model
/// are such multiples anyway, so a model about the origin is treated as one beside it.
class Resolution {
 public:
  /// For a model of a size, model units: the ulp of the power of two above. No resolution, which
  /// rounds nothing, for a size that is zero or not finite.
  explicit Resolution(double size) {
    if (!(size > 0) || !std::isfinite(size)) return;
    int exponent = 0;
    std::frexp(size, &exponent);
    ulp_ = std::ldexp(1.0, exponent - mantissa_bits);
    // At 1.5 · 2^e, one ulp of a double is 2^(e − 52): adding this number rounds to multiples of ulp_.
    shift_ = 1.5 * std::ldexp(1.0, exponent);
    whole_ = std::ldexp(0.25, exponent);
  }

  /// The nearest multiple of ulp(); a coordinate of a quarter of the size and more stays.
  double rounded(double x) const { return std::abs(x) < whole_ ? (x + shift_) - shift_ : x; }
  /// The same for each coordinate.
  Vec3 rounded(const Vec3& x) const { return {rounded(x[0]), rounded(x[1]), rounded(x[2])}; }
  /// The distance of neighbouring coordinates, model units; 0: none.
  double ulp() const { return ulp_; }

 private:
  static constexpr int mantissa_bits = 52;  // of a double, without the leading one
  double ulp_ = 0, shift_ = 0, whole_ = 0;
};

}  // namespace geo
