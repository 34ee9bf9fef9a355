// Numbers as text by strtod() and printf() against the standard library's own.
#include <catch2/catch.hpp>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>

#include "base/number_text.h"
#include "base/random.h"
#include "cases.h"

using namespace geo;

#ifdef __cpp_lib_to_chars
namespace {

template <class Number>
void check_written(Number x) {
  char ours[64], standard[64];
  const std::string written(ours, write_by_printf(ours, x));
  CHECK(written == std::string(standard, std::to_chars(standard, standard + sizeof standard, x).ptr));
}

}  // namespace

TEST_CASE("numbers are written with the characters of std::to_chars()") {
  const auto [first, count] = seeds(20);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    for (int k = 0; k < 200; ++k) {
      const std::uint64_t bits = random.bits();
      double any = 0;
      float single = 0;
      std::memcpy(&any, &bits, sizeof any);
      std::memcpy(&single, &bits, sizeof single);
      if (std::isfinite(any)) check_written(any);
      if (std::isfinite(single)) check_written(single);
      const double usual = random.uniform(-1, 1) * std::pow(10.0, static_cast<int>(random.below(30)) - 12);
      check_written(usual);
      check_written(static_cast<float>(usual));
      check_written(std::round(usual));
    }
  }
  for (const double x : {0.0, -0.0, 1.0, 0.1, 1e5, 100000.0, 123456.0, 1e-5, 0.0001, 1e22, 1e23, 9007199254740993.0,
                         5e-324, 1.7976931348623157e308, double(INFINITY)})
    check_written(x);
}

TEST_CASE("numbers are read as by std::from_chars()") {
  for (const std::string text : {"1",   "-2.5",  "1e5",    "1e",    "1e+",
                                 ".5",  "5.",    "-",      "+1",    " 1",
                                 "",    "x",     "0x10",   "inf",   "-infinity",
                                 "nan", "1e999", "1e-999", "12abc", "0.1000000000000000055511151231257827",
                                 "e5",  ".",     "-.5e-3", "1_000"}) {
    INFO("'" << text << "'");
    double ours = 7, standard = 7;
    const NumberEnd found = read_by_strtod(text.data(), text.data() + text.size(), ours);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), standard);
    CHECK(found.good == (error == std::errc()));
    if (error == std::errc()) CHECK(found.end == end);
    CHECK(std::memcmp(&ours, &standard, sizeof ours) == 0);
  }
}
#endif
