// Parallel loops: each index once, serial scopes, exceptions.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/parallel_threads.h"
#include "kerf/parallel.h"

using namespace geo;

namespace {

// Restores the number of threads also if a check fails.
struct Threads {
  explicit Threads(int count) { set_threads(count); }
  ~Threads() { set_threads(0); }
};

}  // namespace

TEST_CASE("a loop visits each index once, for any number of threads and any grain", "[parallel]") {
  for (const int count : {1, 2, 5}) {
    const Threads threads_set(count);
    CHECK(threads() == count);
    for (const std::size_t n : {0, 1, 99, 10000})
      for (const std::size_t grain : {1, 64, 100000}) {
        std::vector<int> visits(n, 0);
        parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        CAPTURE(count, n, grain);
        REQUIRE(std::accumulate(visits.begin(), visits.end(), std::size_t(0)) == n);
        REQUIRE(std::count(visits.begin(), visits.end(), 1) == std::ptrdiff_t(n));
      }
  }
  CHECK(threads() >= 1);
}

TEST_CASE("a range of the grain's size or less is not divided", "[parallel]") {
  const Threads threads_set(4);
  std::atomic<int> calls{0};
  parallel_for(100, 100, [&](std::size_t begin, std::size_t end) {
    ++calls;
    CHECK((begin == 0 && end == 100));
  });
  CHECK(calls == 1);
}

TEST_CASE("in a serial scope, loops and pairs run in the calling thread", "[parallel]") {
  const Threads threads_set(4);
  const auto self = std::this_thread::get_id();
  std::atomic<int> elsewhere{0}, calls{0};
  const auto run = [&] {
    parallel_for(1000, 1, [&](std::size_t, std::size_t) {
      ++calls;
      elsewhere += std::this_thread::get_id() != self;
    });
    parallel_invoke(
        [&] {
          ++calls;
          elsewhere += std::this_thread::get_id() != self;
        },
        [&] {
          ++calls;
          elsewhere += std::this_thread::get_id() != self;
        });
  };
  {
    const SerialScope outer;
    { const SerialScope inner; }
    run();  // still serial: scopes nest
  }
  CHECK(elsewhere == 0);
  CHECK(calls == 3);  // the loop is one range
}

TEST_CASE("a loop by threads of the standard library visits each index once", "[parallel]") {
  for (const int count : {1, 2, 5})
    for (const std::size_t grain : {0, 1, 7, 1000}) {
      std::vector<std::atomic<int>> visits(300);
      parallel_for_by_threads(count, 300, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)  // a nested loop finds no thread left, and runs all the same
          parallel_for_by_threads(count, 3, 1, [&](std::size_t, std::size_t) { ++visits[i]; });
      });
      for (const auto& visit : visits) CHECK(visit == 3);
    }
  CHECK_THROWS_AS(parallel_for_by_threads(4, 100, 1,
                                          [](std::size_t i, std::size_t) {
                                            if (i == 50) throw std::runtime_error("no");
                                          }),
                  std::runtime_error);
}

TEST_CASE("an exception in one function of a pair leaves loops in the other one whole", "[parallel]") {
  for (const int count : {1, 2, 4}) {
    const Threads threads_set(count);
    for (int run = 0; run < 50; ++run) {
      std::vector<int> visits(1000, 0);
      std::atomic<bool> has_begun{false};
      const auto fails = [&] {
        // Not for ever: one thread may call the functions in turn.
        for (int i = 0; i < 10000 && !has_begun; ++i) std::this_thread::yield();
        throw std::out_of_range("one");
      };
      const auto loops = [&] {
        has_begun = true;
        std::this_thread::sleep_for(std::chrono::microseconds(20));
        parallel_for(visits.size(), 1, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
      };
      if (run % 2 == 0)
        CHECK_THROWS_AS(parallel_invoke(fails, loops), std::out_of_range);
      else
        CHECK_THROWS_AS(parallel_invoke(loops, fails), std::out_of_range);
      CHECK(std::count(visits.begin(), visits.end(), 1) == 1000);
    }
    // The first of two exceptions arrives.
    CHECK_THROWS_AS(parallel_invoke([] { throw std::out_of_range("first"); }, [] { throw std::logic_error("second"); }),
                    std::out_of_range);
  }
}

TEST_CASE("both functions of a pair are called, and exceptions reach the caller", "[parallel]") {
  for (const int count : {1, 3}) {
    const Threads threads_set(count);
    std::atomic<int> sum{0};
    parallel_invoke([&] { sum += 1; }, [&] { sum += 2; });
    CHECK(sum == 3);
    CHECK_THROWS_AS(parallel_invoke([] {}, [] { throw std::out_of_range("second"); }), std::out_of_range);
    CHECK_THROWS_AS(parallel_for(1000, 1,
                                 [](std::size_t begin, std::size_t) {
                                   if (begin == 0) throw std::out_of_range("first");
                                 }),
                    std::out_of_range);
  }
}
