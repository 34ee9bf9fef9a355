// Bodies of different materials in one solid: no material affects another body.
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "kerf/error.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simd_targets.h"

using namespace geo;

namespace {

// Two bars beside each other, along x; the second one is the thinner.
TriangleMesh bar(int which, double gap) {
  TriangleMesh mesh = make_block({1, which == 0 ? 0.4 : 0.3, 0.4}, 0.2);
  for (Vec3& p : mesh.vertices) p.y() += which * (0.4 + gap);
  return mesh;
}

Body bars(double gap, std::span<const int> which, double spacing = 0.1) {
  TriangleMesh mesh;
  NodeSet nodes;
  SampleOptions options;
  options.spacing = spacing;
  options.levels = 1;
  for (const int b : which) {
    const TriangleMesh own = bar(b, gap);
    const NodeSet of = sample_nodes(own, options);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Triangle& t : own.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    mesh.vertices.insert(mesh.vertices.end(), own.vertices.begin(), own.vertices.end());
    nodes.position.insert(nodes.position.end(), of.position.begin(), of.position.end());
    nodes.radius.insert(nodes.radius.end(), of.radius.begin(), of.radius.end());
    nodes.spacing.insert(nodes.spacing.end(), of.spacing.begin(), of.spacing.end());
    nodes.volume.insert(nodes.volume.end(), of.volume.begin(), of.volume.end());
  }
  return build_body(Complex::from_skin(mesh), std::move(nodes));
}

Body both(double gap) { return bars(gap, std::array{0, 1}); }

// So far apart, and so fine, that no block of points has both: what one begins from is nothing to
// the other.
Body far_apart() { return bars(1, std::array{0, 1}, 0.07); }

bool is_second(const Body& body, std::size_t node) { return body.nodes.position[node].y() > 0.4; }

std::vector<std::uint16_t> numbers(const Body& body) {
  std::vector<std::uint16_t> of;
  for (std::size_t i = 0; i < body.nodes.size(); ++i) of.push_back(is_second(body, i));
  return of;
}

Material soft() {
  Material m;
  m.young = 2e4;
  m.density = 300;
  m.damping = 1;
  return m;
}

// Different from soft() in every parameter that may differ.
Material other(Discretisation discretisation) {
  Material m;
  m.model = ElasticModel::saint_venant_kirchhoff;
  m.discretisation = discretisation;
  m.young = 6e5;
  m.poisson = 0.1;
  m.density = 2000;
  m.volume_term = 1e5;
  m.damping = 4;
  m.viscosity = 300;
  m.mode_penalty = 0.2;
  m.yield = 0.001;
  m.creep = 5;
  m.max_plastic = 0.3;
  return m;
}

Environment clamped(const Body& body) {
  Environment env;
  for (const Vec3& x : body.nodes.position) env.fixed.push_back(x.x() < 0.15);
  return env;
}

}  // namespace

TEST_CASE(
    "forces and stiffness of a body are those of its own material, in blocks with points of several materials, too") {
  const Body body = both(0.03);
  for (const auto discretisation : {Discretisation::galerkin, Discretisation::mueller04}) {
    Material first = soft(), second = other(discretisation);
    first.discretisation = discretisation;
    Solid mixed(body, Materials({first, second}, numbers(body))),
        uniform[2] = {Solid(body, first), Solid(body, second)};
    std::size_t among = 0;
    for (const PointBlock& b : SolidDiscretisation::of(mixed).points.blocks)
      for (const MaterialRange& run : b.material_ranges) among += !run.uniform;
    CHECK(among > 0);
    Random random(3);
    std::vector<Vec3> u(body.nodes.size()), p(u.size()),
        own[2] = {std::vector<Vec3>(u.size(), Vec3::Zero()), std::vector<Vec3>(u.size(), Vec3::Zero())};
    for (std::size_t i = 0; i < u.size(); ++i) {
      u[i] = 0.02 * random.direction();
      p[i] = random.direction();
      own[is_second(body, i)][i] = u[i];
    }
    State strained{u, u}, flown = strained;
    for (std::size_t k = 0; k < mixed.point_count(); ++k) {
      const Vec3 by = 0.05 * random.direction();
      flown.plastic.push_back(by.asDiagonal());
    }
    for_each_simd_target([&] {
      for (const State* state : {&strained, &flown}) {
        const auto stress = von_mises_stress(mixed, body.nodes, *state),
                   of_first = von_mises_stress(uniform[0], body.nodes, *state),
                   of_second = von_mises_stress(uniform[1], body.nodes, *state);
        for (std::size_t i = 0; i < u.size(); ++i) REQUIRE(stress[i] == (is_second(body, i) ? of_second : of_first)[i]);
        CHECK(*std::min_element(stress.begin(), stress.end()) > 0);
      }
      for (const bool second_bar : {false, true}) {
        const Solid& alike = uniform[second_bar];
        const auto force = mixed.forces(u), forces = alike.forces(u), product = mixed.stiffness_product(u, p),
                   products = alike.stiffness_product(u, p);
        for (std::size_t i = 0; i < u.size(); ++i) {
          if (is_second(body, i) != second_bar) continue;
          REQUIRE(force[i] == forces[i]);
          REQUIRE(product[i] == products[i]);
        }
        CHECK(mixed.energy(own[second_bar]) == alike.energy(own[second_bar]));
      }
    });
  }
}

TEST_CASE("a body moves as if the other one had the same material, bit for bit") {
  const Body body = far_apart();
  const Material first = soft(), second = other(Discretisation::galerkin);
  const Environment env = clamped(body);
  const auto run = [&](const Materials& materials) {
    Solid solid(body, materials);
    State state = at_rest(body);
    for (int k = 0; k < 6; ++k) solid.step_implicit(state, 0.03, env);
    return state;
  };
  const State mixed = run(Materials({first, second}, numbers(body))), alike[2] = {run(first), run(second)};
  double moved[2] = {0, 0};
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const bool b = is_second(body, i);
    REQUIRE(mixed.displacement[i] == alike[b].displacement[i]);
    REQUIRE(mixed.velocity[i] == alike[b].velocity[i]);
    moved[b] = std::max(moved[b], mixed.displacement[i].norm());
  }
  CHECK(moved[0] > 0.01);
  CHECK(moved[1] > 1e-3);
  // Only the second one flows.
  Solid solid(body, Materials({first, second}, numbers(body)));
  REQUIRE(mixed.plastic.size() == solid.point_count());
  double yielded[2] = {0, 0};
  for (std::size_t b = 0, k = 0; b < SolidDiscretisation::of(solid).points.blocks.size(); ++b)
    for (const MaterialPoint& p : SolidDiscretisation::of(solid).points.blocks[b].points) {
      CHECK(p.material == (p.position.y() > 0.4));
      yielded[p.material] += mixed.plastic[k++].norm();
    }
  CHECK(yielded[0] == 0);
  CHECK(yielded[1] > 0);
}

TEST_CASE("a clamped body sags as it does without the other one") {
  const Body together = both(0.1), alone[2] = {bars(0.1, std::array{0}), bars(0.1, std::array{1})};
  for (const auto discretisation : {Discretisation::galerkin, Discretisation::mueller04}) {
    Material of[2] = {soft(), soft()};
    of[0].damping = of[1].damping = 10;
    of[1].young = 1.2e5;
    of[1].density = 900;
    of[0].discretisation = of[1].discretisation = discretisation;
    const auto sag = [&](const Body& body, const Materials& materials) {
      Solid solid(body, materials);
      State state = at_rest(body);
      const Environment env = clamped(body);
      for (int k = 0; k < 80; ++k) solid.step_implicit(state, 0.1, env, 1e-5);
      double lowest[2] = {0, 0};
      for (std::size_t i = 0; i < body.nodes.size(); ++i)
        lowest[is_second(body, i)] = std::min(lowest[is_second(body, i)], state.displacement[i].z());
      return std::array{lowest[0], lowest[1]};
    };
    const auto mixed = sag(together, Materials({of[0], of[1]}, numbers(together)));
    for (const std::size_t b : {std::size_t(0), std::size_t(1)}) {
      const double own = sag(alone[b], of[b])[b];
      CHECK(own < -0.01);
      // Both runs have the same nodes, but other quadrature cells.
      CHECK(mixed[b] == Approx(own).epsilon(discretisation == Discretisation::mueller04 ? 1e-4 : 0.03));
    }
  }
}

TEST_CASE("after a cut, a solid of several materials equals one built from scratch") {
  for (const auto discretisation : {Discretisation::galerkin, Discretisation::mueller04}) {
    Body body = both(0.03);
    Material first = soft(), second = other(discretisation);
    first.discretisation = discretisation;
    Solid solid(body, Materials({first, second}, numbers(body)));
    State state = at_rest(body);
    const std::size_t nodes = body.nodes.size();
    auto front = begin_front(blade_at({0.52, -0.2, 0.7}, {0.49, 1, 0.7}, {0, 0, -0.15}, 0), false, 1);
    for (int k = 1; k <= 6; ++k)
      solid.update(body, split(body, front, blade_at({0.52, -0.2, 0.7}, {0.49, 1, 0.7}, {0, 0, -0.15}, k)), state);
    REQUIRE(body.nodes.size() > nodes);
    Solid scratch(body, Materials({first, second}, numbers(body)));
    CHECK(SolidDiscretisation::of(solid).points.blocks == SolidDiscretisation::of(scratch).points.blocks);
    CHECK(SolidDiscretisation::of(solid).subdomains == SolidDiscretisation::of(scratch).subdomains);
    double mass[2] = {0, 0};
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      REQUIRE(solid.mass(NodeId(i)) == scratch.mass(NodeId(i)));
      REQUIRE(solid.materials().index(i) == scratch.materials().index(i));
      mass[is_second(body, i)] += solid.mass(NodeId(i));
    }
    CHECK(mass[0] == Approx(0.16 * 300).epsilon(1e-12));
    CHECK(mass[1] == Approx(0.12 * 2000).epsilon(1e-12));
    const auto before = state;
    const Environment env = clamped(body);
    State again = before;
    solid.step_implicit(state, 0.03, env);
    scratch.step_implicit(again, 0.03, env);
    CHECK(state.displacement == again.displacement);
  }
}

TEST_CASE("the fastest wave of all materials decides the number of leapfrog substeps") {
  const Body body = far_apart();
  Material slow = soft(), fast = soft();
  slow.damping = 0;
  fast.young = 5e6;
  fast.density = 100;
  fast.damping = 0;
  const Environment env = clamped(body);
  std::size_t substeps = 0;
  const auto run = [&](const Materials& materials) {
    Solid solid(body, materials);
    State state = at_rest(body);
    for (int k = 0; k < 4; ++k) substeps = static_cast<std::size_t>(solid.step_explicit(state, 0.01, env).substeps);
    return state;
  };
  const State mixed = run(Materials({slow, fast}, numbers(body)));
  const auto fine = substeps;
  const State of_fast = run(fast);
  CHECK(substeps == fine);
  const State of_slow = run(slow);
  CHECK(substeps < fine);
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    if (is_second(body, i))
      REQUIRE(mixed.displacement[i] == of_fast.displacement[i]);
    else
      REQUIRE((mixed.displacement[i] - of_slow.displacement[i]).norm() < 1e-3);
  }
  // A viscous material limits the step by diffusion: it needs more substeps than the fast one.
  Material tough = soft();
  tough.viscosity = 3000;
  run(Materials({tough, fast}, numbers(body)));
  CHECK(substeps > fine);
}

TEST_CASE("invalid materials are refused") {
  const Body body = both(1);
  Material bad = soft(), nodal = soft();
  bad.poisson = 0.7;
  nodal.discretisation = Discretisation::mueller04;
  CHECK_THROWS_WITH(Materials({soft(), bad}, numbers(body)), Catch::Contains("Poisson"));
  CHECK_THROWS_WITH(Materials({soft(), nodal}, numbers(body)), Catch::Contains("same discretisation"));
  CHECK_THROWS_WITH(Materials({soft(), soft()}, {0, 1, 2}), Catch::Contains("material 2"));
  CHECK_THROWS_AS(Materials({}, {}), InputError);
  CHECK_THROWS_WITH(Solid(body, Materials({soft(), soft()}, {0, 1})), Catch::Contains("one for each node"));
}
