// Typed indices and boxes.
#include <catch2/catch.hpp>
#include <limits>
#include <type_traits>
#include <unordered_set>

#include "base/random.h"
#include "cases.h"
#include "kerf/vec.h"

using namespace geo;

TEST_CASE("ids are invalid until they get a value, and compare and hash by it", "[vec]") {
  CHECK_FALSE(NodeId().valid());
  CHECK(NodeId(0u).valid());
  CHECK(NodeId(std::size_t(7)).index() == 7);
  CHECK(NodeId(3u) < NodeId(4u));
  CHECK(NodeId(4u) < NodeId());
  CHECK(NodeId(4u) == NodeId(std::size_t(4)));
  const std::unordered_set<NodeId> ids{NodeId(1u), NodeId(2u), NodeId(1u)};
  CHECK(ids.size() == 2);
}

TEST_CASE("ids of different kinds do not convert into each other", "[vec]") {
  STATIC_REQUIRE_FALSE(std::is_convertible_v<NodeId, VertexId>);
  STATIC_REQUIRE_FALSE(std::is_constructible_v<NodeId, VertexId>);
  STATIC_REQUIRE_FALSE(std::is_convertible_v<std::uint32_t, NodeId>);
  STATIC_REQUIRE_FALSE(std::is_convertible_v<NodeId, std::uint32_t>);
}

TEST_CASE("coordinates are in range up to the largest one, and only finite ones", "[vec]") {
  CHECK(in_range({0, largest_coordinate, -largest_coordinate}));
  CHECK_FALSE(in_range({0, 1.1 * largest_coordinate, 0}));
  CHECK_FALSE(in_range({0, 0, std::numeric_limits<double>::infinity()}));
  CHECK_FALSE(in_range({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
}

TEST_CASE("an empty box meets nothing and has no extent", "[vec]") {
  const Box3 empty, unit{Vec3::Zero(), Vec3::Ones()};
  CHECK(empty.empty());
  CHECK(empty.diagonal() == 0);
  CHECK_FALSE(empty.meets(unit));
  CHECK_FALSE(unit.meets(empty));
  CHECK_FALSE(empty.meets(empty));
  Box3 sum = empty;
  sum.add(unit);
  CHECK((sum.lo == unit.lo && sum.hi == unit.hi));
  sum.add(Box3());
  CHECK((sum.lo == unit.lo && sum.hi == unit.hi));
}

TEST_CASE("boxes meet where they touch", "[vec]") {
  const Box3 unit{Vec3::Zero(), Vec3::Ones()};
  CHECK(unit.meets({{1, 1, 1}, {2, 2, 2}}));
  CHECK_FALSE(unit.meets({{1, 1, std::nextafter(1.0, 2.0)}, {2, 2, 2}}));
  CHECK(unit.grown(0.5).lo == Vec3(-0.5, -0.5, -0.5));
  CHECK(unit.diagonal() == Approx(std::sqrt(3.0)));
  CHECK(unit.center() == Vec3(0.5, 0.5, 0.5));
}

TEST_CASE("boxes on a grid meet if and only if they have a common grid point", "[vec]") {
  const auto [first, count] = seeds(20);
  std::size_t met = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto point = [&] { return Vec3(random.below(4), random.below(4), random.below(4)); };
    const Vec3 p = point(), q = point(), r = point();
    const Box3 a = box_of(p, q, r);
    Box3 b;
    b.add(point());
    b.add(point());
    bool common = false;
    for (int x = 0; x < 4; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = 0; z < 4; ++z) {
          const Box3 cell{Vec3(x, y, z), Vec3(x, y, z)};
          common |= a.meets(cell) && b.meets(cell);
        }
    REQUIRE(a.meets(b) == common);
    REQUIRE(b.meets(a) == common);
    for (const Vec3& corner : {p, q, r}) REQUIRE(a.meets({corner, corner}));
    met += common;
  }
  if (count >= 20) CHECK((met > 0 && met < std::size_t(count)));
}
