// The smoothing kernel of Müller et al. 2004.
#pragma once

#include <numbers>

namespace geo {

/// ω(r, h) = 315 / (64 π h⁹) (h² − r²)³ for r < h, else 0. `r`: distance in the material; `h`:
/// support radius, both in model units. Its integral over space is 1.
inline double kernel(double r, double h) {
  if (r >= h) return 0;
  const double q = h * h - r * r, h3 = h * h * h;
  return 315.0 / (64.0 * std::numbers::pi * h3 * h3 * h3) * q * q * q;
}

}  // namespace geo
