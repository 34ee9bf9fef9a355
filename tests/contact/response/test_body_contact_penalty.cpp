#include "contact/response/body_contact_penalty.h"

#include <catch2/catch.hpp>

#include "assembled_potential.h"
#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

// Contacts of a node with the middle of three others, pressed in by displacements u.
struct RandomContacts {
  std::vector<Vec3> u;
  BodyContactPenalty penalty{0.4, 0.05};
  explicit RandomContacts(Random& random) {
    for (int i = 0; i < 12; ++i) u.push_back(0.2 * random.direction());
    for (int k = 0; k < 6; ++k) {
      std::vector<NodeWeight> stencil{{random.below(4), 1}};
      for (std::uint32_t c = 0; c < 3; ++c) stencil.push_back({4 + c + random.below(3) * (c == 2), -1 / 3.0});
      const Vec3 normal = random.direction();
      penalty.add(stencil, random.uniform(-0.5, 0.1) * normal, normal, random.uniform(1, 5));
    }
  }
};

}  // namespace

TEST_CASE("contact between bodies: forces are derivatives of the energy and sum to zero") {
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    RandomContacts contacts(random);
    BodyContactPenalty& penalty = contacts.penalty;
    penalty.begin_substep(contacts.u, 0, 1);
    std::vector<Vec3> x = contacts.u, way;
    for (Vec3& p : x) p += 0.1 * random.direction(), way.push_back(random.direction());
    const std::vector<Vec3> force = force_of(penalty, x);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& f : force) sum += f;
    CHECK(sum.norm() < 1e-12);
    const double h = 1e-6,
                 slope = (energy_of(penalty, moved(x, h, way)) - energy_of(penalty, moved(x, -h, way))) / (2 * h);
    CHECK(-dot(force, way) == Approx(slope).epsilon(1e-4).margin(1e-5));
  }
}

TEST_CASE("contact between bodies: impulses conserve momentum, press apart, and take energy from slip") {
  const auto [first, count] = seeds(50);
  std::size_t pressed = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // One contact: node 0 against the middle of nodes 1 to 3, which lie in a plane.
    const Vec3 normal = random.direction();
    const double depth = random.uniform(-0.1, 0.3), h = 0.01, stiffness = 100;
    BodyContactPenalty penalty(random.uniform(0, 1), 0.05);
    penalty.add({{0, 1}, {1, -0.5}, {2, -0.25}, {3, -0.25}}, -depth * normal, normal, stiffness);
    const std::vector<Vec3> u(4, Vec3::Zero());
    std::vector<double> inverse_mass;
    std::vector<Vec3> velocity;
    for (int i = 0; i < 4; ++i)
      inverse_mass.push_back(1 / random.uniform(0.5, 2)), velocity.push_back(random.direction());
    const std::vector<Vec3> before = velocity;
    const auto relative = [&](const std::vector<Vec3>& v) { return weighted_sum(penalty.stencil(0), v); };
    const auto slip = [&](const std::vector<Vec3>& v) { return Vec3(relative(v) - normal.dot(relative(v)) * normal); };
    penalty.apply_impulse(u, h, inverse_mass, velocity);
    Vec3 momentum = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i) momentum += (velocity[i] - before[i]) / inverse_mass[i];
    CHECK(momentum.norm() < 1e-12);
    CHECK(penalty.depth(u) == Approx(std::max(0.0, depth)).margin(1e-15));
    if (depth <= 0) {
      CHECK(velocity == before);
      continue;
    }
    ++pressed;
    double inverse = 0;
    for (const auto& e : penalty.stencil(0)) inverse += e.weight * e.weight * inverse_mass[e.node];
    CHECK(normal.dot(relative(velocity) - relative(before)) == Approx(h * stiffness * depth * inverse).epsilon(1e-9));
    CHECK(slip(velocity).norm() <= slip(before).norm() + 1e-12);
    CHECK(slip(velocity).dot(slip(before)) >= -1e-12);  // does not turn round
  }
  REQUIRE(pressed > 0);
}
