// Elementary functions against long double, special values, and bits that no compiler may change.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/elementary.h"
#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

// The error of a value, in ulps of what it should be.
double ulps(double value, long double wanted) {
  const double nearest = static_cast<double>(wanted);
  const double ulp = std::nextafter(std::abs(nearest), std::numeric_limits<double>::infinity()) - std::abs(nearest);
  return std::abs(static_cast<double>((value - wanted) / ulp));
}

}  // namespace

TEST_CASE("elementary functions are as exact as they say", "[elementary]") {
  const auto [first, count] = seeds(1);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    double trigonometric = 0, root = 0, others = 0;
    for (int k = 0; k < 100000; ++k) {
      const double x = k % 4 ? random.uniform(-7, 7) : random.uniform(-1e6, 1e6), e = random.uniform(-30, 30),
                   a = random.uniform(-1, 1), b = random.uniform(-1, 1), positive = std::exp(random.uniform(-20, 20)),
                   wide = std::ldexp(random.uniform(-4, 4), static_cast<int>(random.below(1800)) - 900);
      using Long = long double;
      trigonometric = std::max({trigonometric, ulps(sine(x), std::sin(Long(x))), ulps(cosine(x), std::cos(Long(x)))});
      root = std::max(root, ulps(cube_root(wide), std::cbrt(Long(wide))));
      others =
          std::max({others, ulps(angle_of(a, b), std::atan2(Long(a), Long(b))), ulps(arc_cosine(a), std::acos(Long(a))),
                    ulps(exponential(e), std::exp(Long(e))), ulps(logarithm(positive), std::log(Long(positive)))});
    }
    CHECK(trigonometric < 0.8);
    CHECK(root < 0.501);
    CHECK(others < 4);
  }
}

TEST_CASE("elementary functions at special values", "[elementary]") {
  CHECK(sine(0) == 0);
  CHECK(cosine(0) == 1);
  CHECK(std::isnan(sine(HUGE_VAL)));
  CHECK(angle_of(0, 0) == 0);
  CHECK(angle_of(0, -1) == std::acos(-1.0));
  CHECK(angle_of(-2, 0) == -std::asin(1.0));
  CHECK(arc_cosine(1) == 0);
  CHECK(arc_cosine(-1) == std::acos(-1.0));
  CHECK(exponential(0) == 1);
  CHECK(exponential(-HUGE_VAL) == 0);
  CHECK(logarithm(1) == 0);
  CHECK(logarithm(0) == -HUGE_VAL);
  CHECK(cube_root(-27) == -3);
  CHECK(cube_root(0x1p-1074) == 0x1p-358);
  CHECK(cube_root(HUGE_VAL) == HUGE_VAL);
}

TEST_CASE("elementary functions have the same bits with every compiler", "[elementary]") {
  Random random(1);
  std::uint64_t sum = 0;
  const auto add = [&](double x) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    sum = sum * 6364136223846793005u + bits;
  };
  for (int k = 0; k < 10000; ++k) {
    const double x = random.uniform(-10, 10), y = random.uniform(-1, 1), z = random.uniform(0, 5);
    for (const double value :
         {sine(x), cosine(x), angle_of(y, x), arc_cosine(y), exponential(x), logarithm(z), cube_root(x)})
      add(value);
  }
  CHECK(sum == 0x2fefc284b78b98f2u);
}
