#include "contact/motion/rigid_zones.h"

#include <catch2/catch.hpp>

using namespace geo;

TEST_CASE("zones merge with what they touch, and contain whole triangles only") {
  RigidZones zones(12);
  const Triangle a{0, 1, 2}, b{3, 4, 5}, c{5, 6, 7}, d{8, 9, 10};
  REQUIRE_FALSE(zones.contain(a, a));
  REQUIRE(zones.merge(a, b));
  REQUIRE_FALSE(zones.merge(b, a));  // nothing new
  REQUIRE(zones.contain(a, b));
  REQUIRE_FALSE(zones.contain(a, c));  // shares a vertex, but is not inside
  REQUIRE(zones.merge(d, d));
  REQUIRE_FALSE(zones.contain(a, d));  // another zone
  REQUIRE(zones.vertex_count() == 9);
  REQUIRE(zones.zones() == std::vector<std::vector<std::uint32_t>>{{0, 1, 2, 3, 4, 5}, {8, 9, 10}});
  REQUIRE(zones.merge(c, d));  // joins both through vertex 5
  REQUIRE(zones.contain(a, d));
  REQUIRE(zones.zones() == std::vector<std::vector<std::uint32_t>>{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}});
}
