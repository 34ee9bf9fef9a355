#include <catch2/catch.hpp>

#include "base/random.h"
#include "body/agreement.h"
#include "cases.h"
#include "contact/self_contact.h"
#include "kerf/crossing.h"
#include "kerf/nodes.h"
#include "kerf/shapes.h"

using namespace geo;

namespace {

Body make_body(const TriangleMesh& mesh, double spacing, std::uint64_t seed) {
  SampleOptions sampling;
  sampling.spacing = spacing, sampling.seed = seed;
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
}

TriangleMesh surface_of(const SelfContact& contact) {
  TriangleMesh m;
  m.vertices = contact.positions();
  m.triangles = contact.surface().triangles;
  m.site = contact.surface().site;
  return m;
}

}  // namespace

TEST_CASE("random steps of cut bodies never make the surface cross itself", "[campaign]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Body body = make_body(make_block({1, 1, 1}, 0.25), 0.25, seed);
    Material material;
    material.young = 1e4, material.damping = 0;
    Solid solid(body.nodes, body.graph, material);
    State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
    SelfContact contact(body, solid);
    REQUIRE(count_crossings(surface_of(contact)) == 0);
    const double y = random.uniform(0.3, 0.7);
    auto front = begin_front(std::vector<Vec3>{{-0.3, y, 1.3}, {0.5, y + 0.01, 1.3}, {1.3, y, 1.3}}, false, 1);
    Environment environment;
    environment.gravity.setZero();
    const int depth = 2 + static_cast<int>(random.below(6));
    ContactStats work;
    for (int step = 0; step < 14; ++step) {
      if (step < depth) {
        const double z = 1.1 - 0.22 * (step + 1), sway = random.uniform(-0.05, 0.05);
        const auto delta = split(
            body, front, {{-0.3, y + sway, z}, {0.5, y + sway + 0.05, z}, {1.3, y + sway, z}}, {}, nullptr,
            [&](const Complex& grown, const CrackDelta& crack) { contact.expect(body, solid, state, grown, crack); });
        solid.update(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state);
        contact.follow(body, solid, delta);
        CHECK(count_crossings(surface_of(contact)) == 0);
      }
      const Vec3 push = random.uniform(0, 0.3) * random.direction();
      for (std::size_t i = 0; i < solid.size(); ++i)
        state.velocity[i] +=
            (body.nodes.position[i].y() < y ? 1 : -1) * push + 0.2 * random.uniform(0, 1) * random.direction();
      const std::vector<Vec3> before = state.displacement;
      solid.step_implicit(state, 0.02, environment);
      Vec3 momentum = solid.momentum(state);
      ContactStats one;
      contact.resolve(body, solid, before, 0.02, {}, state, &one);
      work += one;
      CHECK((solid.momentum(state) - momentum).norm() < 1e-9);
      CHECK(count_crossings(surface_of(contact)) == 0);
    }
  }
}
