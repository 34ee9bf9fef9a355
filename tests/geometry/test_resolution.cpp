// Rounding to the resolution of a model.
#include <catch2/catch.hpp>

#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/resolution.h"

using namespace geo;

TEST_CASE("coordinates are multiples of the ulp of a model's size") {
  const Seeds all = seeds(2000);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double size = std::pow(10.0, random.uniform(-15.0, 9.0));
    const Resolution resolution(size);
    // Half an ulp of a number in [size, 2 size), as of one in [size / 2, size).
    REQUIRE(resolution.unit() <= size * 0x1p-51);
    REQUIRE(resolution.unit() >= size * 0x1p-52);
    const double x = random.uniform(-1.0, 1.0) * size * std::pow(10.0, -random.uniform(0.0, 40.0));
    const double rounded = resolution.rounded(x);
    REQUIRE(std::abs(rounded - x) <= 0.5 * resolution.unit());
    const bool is_large = std::abs(x) >= std::ldexp(resolution.unit(), 51);
    REQUIRE((is_large ? rounded == x : std::fmod(rounded, resolution.unit()) == 0));
    REQUIRE(resolution.rounded(rounded) == rounded);
    REQUIRE(resolution.rounded(-x) == -rounded);
    // Beside a model of this size nothing is lost: such coordinates are multiples already.
    const double far = size * random.uniform(1.0, 1e6);
    REQUIRE(resolution.rounded(far) == far);
    REQUIRE(Resolution(2 * size).rounded(2 * x) == 2 * rounded);
  }
  CHECK(Resolution(0).rounded(1e-300) == 1e-300);
  CHECK(Resolution(1).rounded(Vec3(1e-17, -1e-30, 0.25)) == Vec3(0, 0, 0.25));
}
