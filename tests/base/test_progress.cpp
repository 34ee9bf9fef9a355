// Progress reports and the stopwatch.
#include <catch2/catch.hpp>
#include <chrono>
#include <string>
#include <thread>

#include "kerf/progress.h"

using namespace geo;

TEST_CASE("reports reach the listener, who can cancel", "[progress]") {
  std::string phase;
  std::size_t sum = 0;
  const Progress listener = [&](std::string_view name, std::size_t done, std::size_t total) {
    phase = name;
    sum += done;
    return done < total;
  };
  report(listener, "sampling", 1, 3);
  report(listener, "sampling", 2, 3);
  CHECK(phase == "sampling");
  CHECK(sum == 3);
  CHECK_THROWS_AS(report(listener, "sampling", 3, 3), Interrupted);
  CHECK_NOTHROW(report(Progress(), "sampling", 3, 3));
}

TEST_CASE("a stopwatch measures consecutive laps", "[progress]") {
  Stopwatch clock;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double first = clock.lap(), second = clock.lap();
  CHECK(first >= 0.02);
  CHECK(second >= 0);
  CHECK(second < first);
}
