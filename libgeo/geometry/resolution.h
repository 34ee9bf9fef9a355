// The resolution of a model: computed coordinates near zero carry noise that doubles resolve there
// and nowhere else in the model. Exact predicates would see it.
#pragma once

#include <cmath>

#include "kerf/vec.h"

namespace geo {

/// Coordinates that are multiples of a power of two. With the ulp of a model's size, coordinates as
/// large as the model are such multiples anyway, so a model about the origin is treated as one
/// beside it.
class Resolution {
 public:
  /// Bits with which a unit is one ulp of the size, as of coordinates computed in doubles.
  static constexpr int of_doubles = 52;

  /// Units of 2^−bits of the power of two above the size of a model, model units. Rounds nothing
  /// for a size that is zero or not finite. Precondition: bits is at most 52.
  explicit Resolution(double size, int bits = of_doubles) {
    if (!(size > 0) || !std::isfinite(size)) return;
    int exponent = 0;
    std::frexp(size, &exponent);
    unit_ = std::ldexp(1.0, exponent - bits);
    // Beside 1.5 · 2^52 units, doubles are one unit apart: adding this number rounds to units.
    shift_ = 1.5 * std::ldexp(unit_, of_doubles);
    whole_ = std::ldexp(unit_, of_doubles - 1);
  }

  /// The nearest multiple of unit(); a coordinate of 2^51 units and more stays.
  double rounded(double x) const { return std::abs(x) < whole_ ? (x + shift_) - shift_ : x; }
  /// The same for each coordinate.
  Vec3 rounded(const Vec3& x) const { return {rounded(x[0]), rounded(x[1]), rounded(x[2])}; }
  /// The distance of neighbouring coordinates, model units; 0: none.
  double unit() const { return unit_; }

 private:
  double unit_ = 0, shift_ = 0, whole_ = 0;
};

}  // namespace geo
