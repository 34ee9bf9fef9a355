// The claims of docs/validation.md, at quick sizes.
#include <catch2/catch.hpp>

#include "mechanics/validation.h"

namespace {

// Checks each finding; there must be at least `least` of them.
void check(const std::vector<validation::Finding>& findings, std::size_t least) {
  REQUIRE(findings.size() >= least);
  for (const auto& f : findings) {
    INFO(f.what << ": " << f.measured << ", expected " << f.expected << ", error " << f.error());
    CHECK(f.good());
  }
}

}  // namespace

TEST_CASE("validation: rigid motion and patch") {
  check(validation::rigid_motion(0), 1);
  check(validation::patch(0), 2);
}
TEST_CASE("validation: Young's modulus and Poisson's ratio") { check(validation::tension(0), 2); }
TEST_CASE("validation: cantilever, converging") {
  const auto found = validation::cantilever(0);
  check(found, 3);
  CHECK(found.back().error() < found.front().error());
}
TEST_CASE("validation: first bending frequency") { check(validation::frequency(0), 1); }
TEST_CASE("validation: cut bar in free fall") { check(validation::free_fall(0), 1); }
TEST_CASE("validation: spinning bars of any stiffness, at any accuracy") { check(validation::spin(0), 18); }
TEST_CASE("validation: slit bar") { check(validation::slit_bar(0), 1); }
TEST_CASE("validation: bar cut half through") { check(validation::notched_bar(0), 4); }
TEST_CASE("validation: Hertz, converging") {
  const auto found = validation::hertz(0);
  check(found, 2);
  CHECK(found.back().error() < found.front().error());
}
TEST_CASE("validation: Brazilian disk") { check(validation::brazilian_disk(0), 2); }
TEST_CASE("validation: elastic energy at single cuts") { check(validation::energy_at_cuts(0), 3); }
TEST_CASE("validation: a cube stands at zero, whatever its triangles") { check(validation::standing(0), 12); }
TEST_CASE("validation: friction sticks and slides by Coulomb's coefficient") { check(validation::sliding(0), 8); }
TEST_CASE("validation: a stack of cubes stands") { check(validation::stacking(0), 3); }
