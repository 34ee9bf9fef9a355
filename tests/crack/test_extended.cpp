// Extended numbers by integers against x86's own, bit for bit.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "crack/extended.h"

using namespace geo;
using geo::crack::SoftExtended;

#if LDBL_MANT_DIG == 64
namespace {

// A random double: of any size within 2^±range, sometimes with few bits, so that sums tie.
double number(Random& random, int range) {
  const double whole = random.below(2) ? random.uniform(-1, 1) : std::ldexp(1.0 + random.below(4), -2);
  return std::ldexp(random.below(2) ? whole : -whole, static_cast<int>(random.below(2 * range + 1)) - range);
}

// The same bits: differences to doubles read out all 64.
void check_equal(long double expected, SoftExtended found) {
  for (int part = 0; part < 2; ++part) {
    const auto upper = static_cast<double>(expected);
    REQUIRE(static_cast<double>(found) == upper);
    expected -= upper;
    found = found - SoftExtended(upper);
  }
  REQUIRE(expected == 0);
}

}  // namespace

TEST_CASE("sums, products and quotients of extended numbers have the bits of x86's long doubles") {
  const auto [first, count] = seeds(200);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    const int range = c % 3 == 0 ? 2 : c % 3 == 1 ? 40 : 140;
    for (int k = 0; k < 100; ++k) {
      long double x = number(random, range), y = number(random, range);
      SoftExtended a(static_cast<double>(x)), b(static_cast<double>(y));
      // Operands with all 64 bits.
      const double p = number(random, range), q = number(random, 2);
      x *= p;
      a = a * SoftExtended(p);
      y = y * p + q;
      b = b * SoftExtended(p) + SoftExtended(q);
      check_equal(x, a);
      check_equal(y, b);
      check_equal(x + y, a + b);
      check_equal(x - y, a - b);
      check_equal(x * y, a * b);
      check_equal(std::abs(x), abs(a));
      CHECK((x > y) == (a > b));
      if (y != 0) check_equal(x / y, a / b);
    }
  }
}

TEST_CASE("extended numbers are rounded to subnormal doubles as x86's are") {
  const auto [first, count] = seeds(2000);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    const double x = random.uniform(-1, 1), scale = std::ldexp(1.0, -static_cast<int>(random.below(80)) - 1000);
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    CHECK(static_cast<double>(SoftExtended(x) * SoftExtended(scale)) ==
          static_cast<double>(static_cast<long double>(x) * scale));
  }
}
#endif

TEST_CASE("an extended number holds what a double does not") {
  const SoftExtended one(1), small(0x1p-63);
  CHECK(static_cast<double>((one + small) - one) == 0x1p-63);
  CHECK(static_cast<double>((one + SoftExtended(0x1p-64)) - one) == 0);
  CHECK(static_cast<double>(SoftExtended(-6) / SoftExtended(4)) == -1.5);
  CHECK(static_cast<double>(SoftExtended(0) * one) == 0);
}
