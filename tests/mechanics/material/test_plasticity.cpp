// Plastic flow of one point: hand-computed cases and its bounds.
#include "mechanics/material/plasticity.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "base/random.h"

using namespace geo;

TEST_CASE("the inverse plastic stretch undoes a plastic stretch", "[plasticity]") {
  // A stretch of λ has the Green strain ½ (λ² − 1).
  const Vec3 stretch(1.5, 0.8, 1);
  const Mat3 plastic = (0.5 * (stretch.array().square() - 1)).matrix().asDiagonal();
  CHECK((inverse_plastic_stretch(plastic) - Mat3(stretch.cwiseInverse().asDiagonal())).norm() < 1e-14);
  CHECK((inverse_plastic_stretch(Mat3::Zero()) - Mat3::Identity()).norm() < 1e-15);
  // No stretch is smaller than a tenth: its inverse is at most 10.
  const Mat3 collapsed = Vec3(-0.5, 0, 0).asDiagonal();
  CHECK(inverse_plastic_stretch(collapsed)(0, 0) == Approx(10));
}

TEST_CASE("material flows above its yield, at its creep, up to its bound", "[plasticity]") {
  Material m;
  m.yield = 0.1;
  m.creep = 2;
  m.max_plastic = 0.3;
  const auto stretched = [](double strain) -> Mat3 { return Vec3(std::sqrt(1 + 2 * strain), 1, 1).asDiagonal(); };
  const Mat3 none = Mat3::Zero();
  CHECK(plastic_flow(m, none, stretched(0.09), 0.1) == none);
  // 0.2 of elastic strain, of which creep · dt = 0.2 flows.
  CHECK(plastic_flow(m, none, stretched(0.2), 0.1)(0, 0) == Approx(0.04));
  // All of it at most.
  CHECK(plastic_flow(m, none, stretched(0.2), 10)(0, 0) == Approx(0.2));
  CHECK(plastic_flow(m, none, stretched(5), 10).norm() == Approx(0.3));
  // Plastic strain leaves less elastic strain: here 0.05, below the yield.
  Mat3 plastic = none;
  plastic(0, 0) = 0.15;
  CHECK(plastic_flow(m, plastic, stretched(0.2), 10) == plastic);
}
