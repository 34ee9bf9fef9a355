// The nearest number in single precision, as a double.
#pragma once

#include <cmath>

namespace geo {

/// The nearest number in single precision. gcc 12 leaves out a cast to float and back in vectors.
inline double to_single(double x) {
  constexpr int digits = 24;  // binary ones of a float
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, digits)), exponent - digits);
}

}  // namespace geo
