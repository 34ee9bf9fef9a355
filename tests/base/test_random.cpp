// Random numbers: reference values of SplitMix64, ranges, and uniformity.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"

using namespace geo;

TEST_CASE("the generator is SplitMix64", "[random]") {
  // Reference values of Vigna's splitmix64.c with state 1234567.
  Random random(1234567);
  CHECK(random.bits() == 6457827717110365317ull);
  CHECK(random.bits() == 3203168211198807973ull);
  CHECK(random.bits() == 9817491932198370423ull);
  CHECK(random.bits() == 4593380528125082431ull);
  CHECK(random.bits() == 16408922859458223821ull);
}

TEST_CASE("equal seeds give equal sequences, other seeds give others", "[random]") {
  Random a(5), b(5), c(6);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const auto x = a.bits();
    REQUIRE(x == b.bits());
    differs |= x != c.bits();
  }
  CHECK(differs);
}

TEST_CASE("numbers are within their ranges and uniform", "[random]") {
  Random random(17);
  constexpr int n = 70000;
  std::array<int, 7> below{};
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(-2, 3);
    REQUIRE((x >= -2 && x < 3));
    sum += x;
    const auto k = random.below(7);
    REQUIRE(k < 7);
    ++below[k];
  }
  CHECK(sum / n == Approx(0.5).margin(0.03));  // five standard deviations
  for (const int times : below) CHECK(times == Approx(n / 7).margin(500));
  CHECK(random.below(1) == 0);
}

TEST_CASE("directions are unit vectors, as many on each side of any plane", "[random]") {
  Random random(3);
  constexpr int n = 20000;
  Vec3 mean = Vec3::Zero();
  Mat3 moments = Mat3::Zero();
  for (int i = 0; i < n; ++i) {
    const Vec3 d = random.direction();
    REQUIRE(d.norm() == Approx(1).margin(1e-12));
    mean += d / n;
    moments += d * d.transpose() / n;
  }
  CHECK(mean.norm() < 0.03);
  CHECK((moments - Mat3::Identity() / 3).norm() < 0.03);
}
