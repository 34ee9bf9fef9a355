// Uninitialised arrays: size, alignment, moves.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <numeric>

#include "base/uninitialized_array.h"

using namespace geo;

TEST_CASE("an array holds what is written to it", "[array]") {
  UninitializedArray<std::uint32_t> array(1000);
  REQUIRE(array.size() == 1000);
  std::iota(array.begin(), array.end(), 0u);
  CHECK(array[999] == 999);
  const std::span<const std::uint32_t> view = array;
  CHECK(std::accumulate(view.begin(), view.end(), 0u) == 499500);
  const auto* const data = array.data();
  const UninitializedArray<std::uint32_t> moved = std::move(array);
  CHECK(moved.data() == data);
  CHECK(moved[7] == 7);
}

TEST_CASE("an empty array has no elements", "[array]") {
  const UninitializedArray<double> none, zero(0);
  CHECK(none.size() == 0);
  CHECK(none.begin() == none.end());
  CHECK(zero.begin() == zero.end());
}

TEST_CASE("elements are aligned as their type demands", "[array]") {
  struct alignas(64) Line {
    double x[8];
  };
  for (std::size_t n = 1; n < 20; ++n)
    CHECK(reinterpret_cast<std::uintptr_t>(UninitializedArray<Line>(n).data()) % 64 == 0);
}

TEST_CASE("memory with huge pages can be written to its ends", "[array]") {
  UninitializedArray<std::uint8_t> array(std::size_t(9) << 20);
  std::fill(array.begin(), array.end(), std::uint8_t(5));
  CHECK((array[0] == 5 && array[array.size() - 1] == 5));
}
