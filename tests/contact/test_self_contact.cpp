#include "contact/self_contact.h"

#include <catch2/catch.hpp>
#include <stdexcept>

#include "base/random.h"
#include "cases.h"
#include "contact/cut_body.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

Body make_body(const TriangleMesh& mesh, double spacing, std::uint64_t seed) {
  SampleOptions sampling;
  sampling.spacing = spacing;
  sampling.seed = seed;
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
}

Material soft() {
  Material material;
  material.young = 1e4;
  material.damping = 0;
  return material;
}

// A unit block that a straight blade cuts from above, in the plane of about y = `y`.
struct CutBlock {
  Body body;
  Solid solid;
  State state;
  SelfContact contact;
  double y;
  FrontState front;
  Environment environment;

  CutBlock(std::uint64_t seed, double y_)
      : body(make_body(make_block({1, 1, 1}, 0.25), 0.25, seed)),
        solid(body.nodes, body.graph, soft()),
        state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())},
        contact(body, solid),
        y(y_),
        front(begin_front(std::vector<Vec3>{{-0.3, y, 1.3}, {0.5, y + 0.01, 1.3}, {1.3, y, 1.3}}, false, 1)) {
    environment.gravity.setZero();
  }
  void cut_to(double z, double sway) {
    cut(body, solid, state, contact, front, {{-0.3, y + sway, z}, {0.5, y + sway + 0.05, z}, {1.3, y + sway, z}});
  }
  // Throws the two halves against each other, or apart, by the sign of `velocity`.
  void throw_halves(double velocity) {
    for (std::size_t i = 0; i < solid.size(); ++i)
      state.velocity[i].y() += body.nodes.position[i].y() < y ? velocity : -velocity;
  }
  ContactStats explicit_step(double dt) {
    const std::vector<Vec3> before = state.displacement;
    solid.step_implicit(state, dt, environment);  // without contact
    return contact.finish_step_with_impulses(body, solid, before, dt, {}, state);
  }
  ContactStats implicit_step(double dt) {
    ContactStep step = contact.begin_step(body, solid, state, dt, environment);
    environment.contact.clear();
    if (Potential* potential = step.potential()) environment.contact.push_back(potential);
    solid.step_implicit(state, dt, environment);
    environment.contact.clear();
    return contact.finish_step(std::move(step), solid, state.displacement);
  }
};

}  // namespace

TEST_CASE("random steps of cut bodies never make the surface cross itself", "[campaign]") {
  const auto [first, count] = seeds(20);
  ContactStats total;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    CutBlock block(seed, random.uniform(0.3, 0.7));
    REQUIRE(count_crossings(mesh_of(block.contact)) == 0);
    const int depth = 2 + static_cast<int>(random.below(6));
    for (int step = 0; step < 14; ++step) {
      if (step < depth) {
        const double z = 1.1 - 0.22 * (step + 1);
        block.cut_to(z, random.uniform(-0.05, 0.05));
        CHECK(count_crossings(mesh_of(block.contact)) == 0);
      }
      const Vec3 kick = random.uniform(0, 0.3) * random.direction();
      for (std::size_t i = 0; i < block.solid.size(); ++i)
        block.state.velocity[i] += (block.body.nodes.position[i].y() < block.y ? 1 : -1) * kick +
                                   0.2 * random.uniform(0, 1) * random.direction();
      const std::vector<Vec3> before = block.state.displacement;
      block.solid.step_implicit(block.state, 0.02, block.environment);
      const Vec3 momentum = block.solid.momentum(block.state);
      total += block.contact.finish_step_with_impulses(block.body, block.solid, before, 0.02, {}, block.state);
      CHECK((block.solid.momentum(block.state) - momentum).norm() < 1e-9);
      CHECK(count_crossings(mesh_of(block.contact)) == 0);
    }
  }
  INFO(total.touching << " touching, " << total.opened << " opened, " << total.planes << " planes, " << total.in_zones
                      << " in zones, " << total.held << " held, error " << total.tracking_error);
  REQUIRE(total.touching > 0);  // kicks across the cut have either sign: halves meet,
  REQUIRE(total.opened > 0);    // and separate
  REQUIRE(total.held == 0);     // never so tightly that nothing can move
  // A kick moves nodes at most 0.5 · 0.02 a step, and impulses resolve that in the same step.
  REQUIRE(total.tracking_error < 0.1);
}

TEST_CASE("halves of a cut block that are thrown together touch, and that are thrown apart open, in both integrators") {
  for (const bool implicit : {false, true}) {
    INFO((implicit ? "implicit" : "explicit"));
    const auto thrown = [&](double velocity, double& edge) {
      CutBlock block(3, 0.5);
      for (const double z : {0.85, 0.6, 0.35, 0.1, -0.15, -0.4}) block.cut_to(z, 0);
      ContactStats total;
      block.throw_halves(velocity);
      for (int step = 0; step < 3; ++step) total += implicit ? block.implicit_step(0.02) : block.explicit_step(0.02);
      REQUIRE(count_crossings(mesh_of(block.contact)) == 0);
      edge = block.contact.surface().edge;
      return total;
    };
    double edge = 0;
    const ContactStats together = thrown(0.5, edge), apart = thrown(-0.5, edge);
    REQUIRE(together.touching > 10 * apart.touching);
    REQUIRE(together.touching > 0);
    REQUIRE(apart.opened > 0);
    REQUIRE(apart.opened > 2 * together.opened);  // pressed sheets open only where they shear
    // Nothing is in the way of halves that separate, so the surface is where Eq. 1 puts it, but for
    // the gap.
    REQUIRE(apart.tracking_error < 1e-2 * edge);
  }
}

TEST_CASE("steps and plans that no longer fit the surface are refused") {
  CutBlock block(1, 0.5);
  block.cut_to(0.7, 0);
  const auto begin = [&] {
    return block.contact.begin_step(block.body, block.solid, block.state, 0.02,
                                    {.gravity = Vec3::Zero(), .fixed = {}, .load = {}, .contact = {}});
  };
  const auto finish = [&](ContactStep step) {
    return block.contact.finish_step(std::move(step), block.solid, block.state.displacement);
  };
  SECTION("a step that was finished") {
    ContactStep step = begin();
    finish(std::move(step));
    CHECK_THROWS_AS(finish(std::move(step)), std::logic_error);
  }
  SECTION("a step that was begun before a crack step") {
    ContactStep step = begin();
    block.cut_to(0.5, 0);
    CHECK_THROWS_AS(finish(std::move(step)), std::logic_error);
  }
  SECTION("a step that was begun before another one ended") {
    ContactStep first = begin(), second = begin();
    finish(std::move(second));
    CHECK_THROWS_AS(finish(std::move(first)), std::logic_error);
  }
  SECTION("an embedding that was planned before the surface moved") {
    std::optional<EmbeddingPlan> plan;
    const std::vector<Vec3> next{{-0.3, 0.5, 0.4}, {0.5, 0.55, 0.4}, {1.3, 0.5, 0.4}};
    CrackTransaction step(block.body, advance_of(block.front, next, {}), nullptr);
    const BodyDelta delta = step.commit([&](const Complex& grown, const CrackDelta& crack) {
      plan = block.contact.plan_embedding(block.body, block.solid, block.state, grown, crack);
      finish(begin());
    });
    REQUIRE(plan.has_value());
    CHECK_THROWS_AS(block.contact.commit(std::move(*plan), block.body, delta), std::logic_error);
  }
}
