// Keys of faces.
#include <catch2/catch.hpp>

#include "surface/face_key.h"

using namespace geo;

TEST_CASE("a face key ignores order, and is_even() tells rotations from reflections") {
  const auto ids = [](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return std::array{VertexId(a), VertexId(b), VertexId(c)};
  };
  CHECK(face_key(ids(5, 2, 9)) == std::array<std::uint32_t, 3>{2, 5, 9});
  CHECK(is_even(ids(2, 5, 9)) == is_even(ids(5, 9, 2)));
  CHECK(is_even(ids(2, 5, 9)) != is_even(ids(5, 2, 9)));
}
