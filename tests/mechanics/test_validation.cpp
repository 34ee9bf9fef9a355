// What docs/validation.md says, at quick sizes.
#include <catch2/catch.hpp>

#include "mechanics/validation.h"

namespace {

void check(const std::vector<validation::Finding>& findings) {
  for (const auto& f : findings) {
    INFO(f.what << ": " << f.measured << ", expected " << f.expected << ", error " << f.error());
    CHECK(f.good());
  }
}

}  // namespace

TEST_CASE("validation: rigid motion and patch") {
  check(validation::rigid_motion(0));
  check(validation::patch(0));
}
TEST_CASE("validation: Young's modulus and Poisson's ratio") { check(validation::tension(0)); }
TEST_CASE("validation: cantilever, converging") {
  const auto found = validation::cantilever(0);
  check(found);
  CHECK(found.back().error() < found.front().error());
}
TEST_CASE("validation: first bending frequency") { check(validation::frequency(0)); }
TEST_CASE("validation: cut bar in free fall") { check(validation::free_fall(0)); }
TEST_CASE("validation: what spins, however stiff it is and however little accuracy is asked for") {
  check(validation::spin(0));
}
TEST_CASE("validation: slit bar") { check(validation::slit_bar(0)); }
TEST_CASE("validation: bar cut half through") { check(validation::notched_bar(0)); }
TEST_CASE("validation: Hertz, converging") {
  const auto found = validation::hertz(0);
  check(found);
  CHECK(found.back().error() < found.front().error());
}
TEST_CASE("validation: Brazilian disk") { check(validation::brazilian_disk(0)); }
TEST_CASE("validation: elastic energy at single cuts") { check(validation::energy_at_cuts(0)); }
