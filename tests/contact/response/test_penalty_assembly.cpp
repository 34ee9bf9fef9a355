#include "contact/response/penalty_assembly.h"

#include <catch2/catch.hpp>

#include "assembled_potential.h"
#include "contact/cut_body.h"
#include "contact/response/impulse_response.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

Body block() {
  SampleOptions sampling;
  sampling.spacing = 0.3;
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
}

}  // namespace

TEST_CASE("the free motion is inertia and gravity, and fixed nodes stay") {
  const Body body = block();
  const Solid solid(body.nodes, body.graph, Material());
  const std::size_t n = solid.size();
  State state{std::vector<Vec3>(n, Vec3(0.1, 0, 0)), std::vector<Vec3>(n, Vec3(0, 2, 0))};
  std::vector<std::uint8_t> fixed(n, 0);
  fixed[3] = 1;
  const FreeMotion free =
      free_motion(body, solid, state, 0.5, {.gravity = {0, 0, -8}, .fixed = fixed, .load = {}, .contact = {}});
  for (std::size_t i = 0; i < n; ++i) {
    // u + dt v + dt² g, as an implicit Euler step without forces has it.
    CHECK((free.displacement[i] - (i == 3 ? Vec3(0.1, 0, 0) : Vec3(0.1, 1, -2))).norm() < 1e-15);
    CHECK(free.inverse_mass[i] == 1 / solid.mass(NodeId(i)));
  }
  double spacing = 0;
  for (const double s : body.nodes.spacing) spacing += s / double(n);
  CHECK(free.mean_spacing == Approx(spacing).epsilon(1e-12));
}

TEST_CASE("sides of a closed sheet get contacts where the free motion presses them together, not where it opens them") {
  Body body = block();
  Solid solid(body.nodes, body.graph, Material());
  State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  SelfContact contact(body, solid);
  FrontState front = begin_front(std::vector<Vec3>{{-0.3, -0.3, 0.52}, {-0.3, 1.3, 0.52}}, false, 1);
  cut(body, solid, state, contact, front, {{1.3, -0.3, 0.48}, {1.3, 1.3, 0.48}});
  for (const double velocity : {0.5, -0.5}) {
    INFO(velocity);
    for (std::size_t i = 0; i < solid.size(); ++i)
      state.velocity[i] = {0, 0, body.nodes.position[i].z() < 0.5 ? velocity : -velocity};
    ContactStep step =
        contact.begin_step(body, solid, state, 0.1, {.gravity = Vec3::Zero(), .fixed = {}, .load = {}, .contact = {}});
    std::vector<Vec3> u = state.displacement;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = 0.1 * state.velocity[i];
    if (velocity < 0) {
      // The sides lose contact: what the sheet's rim has left has no energy.
      if (step.potential()) CHECK(energy_of(*step.potential(), u) == Approx(0).margin(1e-6));
      continue;
    }
    REQUIRE(step.potential() != nullptr);
    Potential& penalty = *step.potential();
    penalty.begin_substep(state.displacement, 0, 1);
    REQUIRE(energy_of(penalty, u) > 1);
    Vec3 lower = Vec3::Zero(), sum = Vec3::Zero();
    for (std::size_t k = 0; k < penalty.size(); ++k) {
      const Vec3 force = penalty.derivatives(k, weighted_sum(penalty.stencil(k), u)).force;
      for (const auto& e : penalty.stencil(k)) {
        sum += e.weight * force;
        if (body.nodes.position[e.node].z() < 0.5) lower += e.weight * force;
      }
    }
    CHECK(lower.z() < 0);
    CHECK(std::abs(lower.x()) < 0.5 * std::abs(lower.z()));
    CHECK(sum.norm() < 1e-9 * lower.norm());
  }
}

TEST_CASE("impulses after a step conserve momentum and take the approach of the two sides of a sheet") {
  Body body = block();
  Solid solid(body.nodes, body.graph, Material());
  State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  SelfContact contact(body, solid);
  FrontState front = begin_front(std::vector<Vec3>{{-0.3, -0.3, 0.52}, {-0.3, 1.3, 0.52}}, false, 1);
  cut(body, solid, state, contact, front, {{1.3, -0.3, 0.48}, {1.3, 1.3, 0.48}});
  MovingSurface surface(contact.surface(), contact.positions());
  const std::vector<Vec3> before = state.displacement;
  const double dt = 0.1;
  const auto approach = [&] {  // kinetic energy of the vertical motion
    double sum = 0;
    for (std::size_t i = 0; i < solid.size(); ++i)
      sum += 0.5 * solid.mass(NodeId(i)) * state.velocity[i].z() * state.velocity[i].z();
    return sum;
  };
  for (std::size_t i = 0; i < solid.size(); ++i) {
    state.velocity[i] = {0, 0, body.nodes.position[i].z() < 0.5 ? 0.5 : -0.5};
    state.displacement[i] += dt * state.velocity[i];
  }
  const Vec3 momentum = solid.momentum(state);
  const double energy = approach();
  BroadPhase near;
  const std::size_t contacts = resolve_with_impulses(
      {solid, contact.weights(), before, dt, {}}, {1e-4 * contact.surface().edge, 0.3, 0.3, 2}, surface, near, state);
  REQUIRE(contacts > 0);
  CHECK((solid.momentum(state) - momentum).norm() < 1e-9);
  CHECK(approach() < energy);
}
