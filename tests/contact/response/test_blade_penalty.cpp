#include "contact/response/blade_penalty.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

// A blade with its edge on the x axis and its back above, at z = 1; it cuts downwards. At the back
// it is 0.2 thick, so its faces have the slope 0.1.
BladeWedge straight_blade() { return {{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}, false, {0, 0, 1}, 0.2, 3}; }

struct Nodes {
  std::vector<Vec3> position, displacement;
  std::vector<double> clearance, mass;
  void add(const Vec3& x, double gap = 0) {
    position.push_back(x);
    displacement.push_back(Vec3::Zero());
    clearance.push_back(gap);
    mass.push_back(2);
  }
  BladeNodes view() const {
    return {position, displacement, clearance, [&](std::size_t i) { return clearance[i]; },
            [&](std::size_t i) { return mass[i]; }};
  }
};

}  // namespace

TEST_CASE("a node inside a wedge is pressed out of the face on its side, by its depth behind that face") {
  Nodes nodes;
  nodes.add({0.5, 0.02, 0.5});
  BladePenalty penalty;
  penalty.add(0, straight_blade(), nodes.view());
  REQUIRE(penalty.size() == 1);
  REQUIRE(penalty.stencil(0).size() == 1);
  REQUIRE(penalty.stencil(0)[0].weight == 1);
  // The face is y = 0.1 z. Its normal is (0, 1, −0.1) / √1.01; at z = 0.5 the node is (0.05 − 0.02)
  // below.
  const Vec3 normal = Vec3(0, 1, -0.1).normalized();
  const double depth = 0.03 / std::sqrt(1.01), stiffness = 2 * 3;
  CHECK(penalty.energy(0, Vec3::Zero()) == Approx(0.5 * stiffness * depth * depth).epsilon(1e-12));
  CHECK((penalty.derivatives(0, Vec3::Zero()).force - stiffness * depth * normal).norm() < 1e-12);
  CHECK(penalty.energy(0, {0, 0.04, 0}) == 0);  // out of it
  CHECK(penalty.derivatives(0, {0, 0.04, 0}).hessian.isZero(0));
  CHECK((penalty.reaction({Vec3::Zero()}, 2)[0] + stiffness * depth * normal).norm() < 1e-12);
  CHECK(penalty.reaction({Vec3::Zero()}, 2)[1].isZero(0));  // another blade
}

TEST_CASE("only nodes beside a flank, whose surface the wedge may reach, are in contact") {
  Nodes nodes;
  nodes.add({0.5, 0.02, -0.1});       // below the edge
  nodes.add({0.5, 0.02, 1.1});        // above the back
  nodes.add({1.1, 0.02, 0.5});        // beyond the end of the edge
  nodes.add({0.5, 0.15, 0.5});        // beside it, farther than half its thickness
  nodes.add({0.5, 0.15, 0.5}, 0.06);  // the same with surface nearer by 0.06
  nodes.add({0.5, -0.02, 0.5});       // on the other side
  BladePenalty penalty;
  penalty.add(0, straight_blade(), nodes.view());
  REQUIRE(penalty.size() == 2);
  CHECK(penalty.stencil(0)[0].node == 4);
  CHECK(penalty.stencil(1)[0].node == 5);
  CHECK(penalty.energy(0, Vec3::Zero()) == 0);  // 0.15 − 0.06 is still outside the face at 0.05
  CHECK(penalty.energy(0, {0, -0.05, 0}) > 0);
  CHECK(penalty.derivatives(1, Vec3::Zero()).force.y() < 0);
}

TEST_CASE("a blade's force is minus the derivative of its energy, and reactions are opposite to forces") {
  const auto [first, count] = seeds(20);
  std::size_t contacts = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Nodes nodes;
    for (int i = 0; i < 200; ++i)
      nodes.add({random.uniform(-1, 1), random.uniform(-0.15, 0.15), random.uniform(0, 1)}, random.uniform(0, 0.05));
    BladeWedge wedge = straight_blade();
    for (Vec3& p : wedge.edge) p += 0.05 * random.direction();
    BladePenalty penalty;
    penalty.add(0, wedge, nodes.view());
    contacts += penalty.size();
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < penalty.size(); ++k) {
      const Vec3 d = 0.01 * random.direction(), way = random.direction();
      nodes.displacement[penalty.stencil(k)[0].node] = d;
      const auto at = penalty.derivatives(k, d);
      sum += at.force;
      const double h = 1e-6;
      const double slope = (penalty.energy(k, d + h * way) - penalty.energy(k, d - h * way)) / (2 * h);
      CHECK(-at.force.dot(way) == Approx(slope).epsilon(1e-5).margin(1e-5));
    }
    CHECK((penalty.reaction(nodes.displacement, 1)[0] + sum).norm() < 1e-12 * (1 + sum.norm()));
  }
  REQUIRE(contacts > 100);
}
