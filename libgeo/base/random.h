// Seeded random numbers that are the same on every platform, unlike the standard's distributions.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/elementary.h"
#include "kerf/vec.h"

namespace geo {

/// The SplitMix64 generator (Steele, Lea, Flood 2014): eight bytes of state; every seed is good.
class Random {
 public:
  /// Equal seeds give equal sequences.
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// 64 random bits.
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Uniform in [lo, hi).
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Uniform in {0, …, n − 1}; n > 0.
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((bits() >> 32) * n >> 32); }
  /// Uniform on the unit sphere.
  Vec3 direction() {
    const double z = uniform(-1.0, 1.0), phi = uniform(0.0, 6.283185307179586), r = std::sqrt(1.0 - z * z);
    return {r * cosine(phi), r * sine(phi), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace geo
