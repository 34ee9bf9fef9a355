#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <numeric>

#include "assembled_potential.h"
#include "base/random.h"
#include "base/union_find.h"
#include "cases.h"
#include "contact/cut_body.h"
#include "contact/detection/find_crossings.h"
#include "contact/detection/triangle_planes.h"
#include "contact/response/self_contact_penalty.h"
#include "contact/self_contact.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

// A stencil of these nodes with random weights that sum to zero.
RelativeStencil row_of(const std::vector<std::uint32_t>& nodes, Random& random) {
  RelativeStencil row;
  double left = 0;
  for (const auto node : nodes) {
    const double w = row.entries.size() + 1 < nodes.size() ? random.uniform(-0.5, 0.5) : -left;
    row.entries.push_back({node, w});
    left += w;
  }
  return row;
}

}  // namespace

TEST_CASE("the self-contact penalty's force is the energy's slope, and forces sum to zero") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    constexpr std::size_t n = 9;
    const auto vectors = [&](double size) {
      std::vector<Vec3> v;
      for (std::size_t i = 0; i < n; ++i) v.push_back(size * random.direction());
      return v;
    };
    const std::vector<Vec3> u = vectors(1);
    SelfContactPenalty penalty({0.4, 0.05});
    for (int i = 0; i < 6; ++i) {
      std::vector<std::uint32_t> all_nodes(n);
      std::iota(all_nodes.begin(), all_nodes.end(), 0);
      const RelativeStencil row = row_of(all_nodes, random);
      penalty.add(row, random.direction(), random.uniform(-0.2, 0.5), random.uniform(1, 5), u);
    }
    std::vector<Vec3> at = u, way = vectors(1);
    for (std::size_t i = 0; i < n; ++i) at[i] += 0.2 * random.direction();
    penalty.begin_substep(u, 0, 1);
    AssembledPotential assembled(penalty, u);
    const std::vector<Vec3> force = assembled.force(at), product = assembled.product(way);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& f : force) sum += f;
    CHECK(sum.norm() < 1e-12);
    const double step = 1e-6;
    CHECK((assembled.energy(moved(at, step, way)) - assembled.energy(moved(at, -step, way))) / (2 * step) ==
          Approx(-dot(force, way)).epsilon(1e-4).margin(1e-5));
    CHECK(dot(product, way) >= 0);  // the secant Hessian is positive semidefinite
    std::vector<Mat3> blocks(n, Mat3::Zero());
    assembled.sum().add_diagonal_blocks(blocks);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Vec3> unit(n, Vec3::Zero());
      unit[i] = Vec3::UnitY();
      const std::vector<Vec3> column = assembled.product(unit);
      CHECK(column[i].y() > 0);
      CHECK(blocks[i](1, 1) >= column[i].y() * (1 - 1e-6));  // no less than the matrix has there
      CHECK(blocks[i](1, 1) < 20 * column[i].y());
    }
  }
}

TEST_CASE(
    "nodes that a penalty couples are in one island by the pairs it reports, and each island has its own energy") {
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    constexpr std::uint32_t n = 24;
    std::vector<Vec3> u, at;
    for (std::uint32_t i = 0; i < n; ++i) {
      u.push_back(random.direction());
      at.push_back(u.back() + 0.3 * random.direction());
    }
    SelfContactPenalty touch({0.4, 0.05});
    for (int r = 0; r < 7; ++r) {
      std::vector<std::uint32_t> some;
      for (int k = 0; k < 3; ++k) some.push_back(static_cast<std::uint32_t>(random.below(n)));
      const RelativeStencil row = row_of(some, random);
      const Vec3 normal = random.direction();
      touch.add(row, normal, random.uniform(0, 0.5), random.uniform(1, 5), u);
    }
    touch.begin_substep(u, 0, 1);
    AssembledPotential assembled(touch, u);
    UnionFind joined(n);
    std::vector<std::uint32_t> part(n);
    std::iota(part.begin(), part.end(), 0u);
    for (const auto& [i, j] : assembled.sum().coupled_components(part)) joined.unite(i, j);
    for (std::uint32_t i = 0; i < n; ++i) part[i] = joined.find(i);
    const std::vector<Vec3> force = assembled.force(at);
    const std::vector<char> all(n, 1);
    std::vector<double> energy(n, 0), moved(n, 0);
    assembled.sum().add_energy(at, part, all, energy);
    CHECK(std::accumulate(energy.begin(), energy.end(), 0.0) == Approx(assembled.energy(at)).epsilon(1e-12));
    for (std::uint32_t i = 0; i < n; ++i) {
      std::vector<Vec3> unit(n, Vec3::Zero()), x = at;
      unit[i] = random.direction();
      x[i] += 0.2 * unit[i];
      const std::vector<Vec3> column = assembled.product(unit);
      moved.assign(n, 0);
      assembled.sum().add_energy(x, part, all, moved);
      for (std::uint32_t j = 0; j < n; ++j)
        if (part[j] != part[i]) {
          CHECK(column[j].isZero(0));
          CHECK(moved[j] == energy[j]);
        }
    }
  }
}

namespace {

// Springs to relative displacement 0, each active while it is switched on.
struct SwitchedSprings : Potential {
  std::vector<std::vector<NodeWeight>> nodes;
  std::vector<Mat3> stiffness;
  std::vector<char> on;
  std::size_t size() const override { return nodes.size(); }
  Stencil stencil(std::size_t k) const override { return nodes[k]; }
  double energy(std::size_t k, const Vec3& d) const override { return on[k] ? 0.5 * d.dot(stiffness[k] * d) : 0; }
  Derivatives derivatives(std::size_t k, const Vec3& d) const override {
    return on[k] ? Derivatives{-stiffness[k] * d, stiffness[k]} : Derivatives{};
  }
};

}  // namespace

TEST_CASE(
    "contacts that become active in the middle of a step, or cease to be, are in forces and products like others") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::size_t n = 40, total = 600;
    SwitchedSprings springs;
    for (std::size_t r = 0; r < total; ++r) {
      std::vector<NodeWeight> row;
      for (std::uint32_t i = static_cast<std::uint32_t>(random.below(8)); i < n && r % 17 != 3;
           i += 1 + static_cast<std::uint32_t>(random.below(9)))
        row.push_back({i, random.uniform(-1, 1)});
      const Vec3 d = random.direction();
      springs.nodes.push_back(row);
      springs.stiffness.push_back(random.uniform(1, 3) * d * d.transpose());
      springs.on.push_back(0);
    }
    const std::vector<Vec3> begun(n, Vec3::Zero());
    AssembledPotential assembled(springs, begun);
    for (int round = 0; round < 12; ++round) {
      const double some = std::array{0.0, 0.3, 0.01, 0.002, 0.05, 0.5}[static_cast<std::size_t>(random.below(6))];
      for (auto& on : springs.on)
        if (random.uniform() < some) on = !on;
      std::vector<Vec3> u, p, force(n, Vec3::Zero()), product = force;
      for (std::size_t i = 0; i < n; ++i) {
        u.push_back(random.direction());
        p.push_back(random.direction());
      }
      double energy = 0;
      for (std::size_t r = 0; r < total; ++r) {
        if (!springs.on[r]) continue;
        const Vec3 way = weighted_sum(springs.nodes[r], u),
                   pull = springs.stiffness[r] * weighted_sum(springs.nodes[r], p);
        energy += springs.energy(r, way);
        for (const auto& e : springs.nodes[r]) {
          force[e.node] -= e.weight * springs.stiffness[r] * way;
          product[e.node] += e.weight * pull;
        }
      }
      CHECK(assembled.energy(u) == Approx(energy).epsilon(1e-12).margin(1e-300));
      const auto pushed = assembled.force(u), multiplied = assembled.product(p);
      for (std::size_t i = 0; i < n; ++i) {
        CHECK((pushed[i] - force[i]).norm() < 1e-11);
        CHECK((multiplied[i] - product[i]).norm() < 1e-3);  // in single precision
      }
    }
  }
}

TEST_CASE("triangles that the plane of one separates at both ends do not meet in between") {
  // Against a slow oracle: the motion in 500 steps, exactly.
  const auto [first, count] = seeds(300);
  std::size_t parted = 0, met = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
    const std::vector<std::uint32_t> representative = {0, 1, 2, 3, 4, 5};
    std::vector<Vec3> from, to;
    for (int v = 0; v < 6; ++v)
      from.push_back(Vec3(v < 3 ? 0 : 0.4, 0, 0) + random.uniform(0.2, 0.6) * random.direction());
    for (int v = 0; v < 6; ++v)
      to.push_back(from[static_cast<std::size_t>(v)] + random.uniform(0, 0.8) * random.direction());
    const TrianglePlanes planes(triangles, from, to);
    bool meets = false;
    for (int step = 0; step <= 500 && !meets; ++step) {
      std::vector<Vec3> at;
      for (std::size_t v = 0; v < 6; ++v) at.push_back(from[v] + step / 500.0 * (to[v] - from[v]));
      meets = !find_crossings(triangles, at, representative, false).empty();
    }
    const bool part = planes.separates(0, 1, 1e-12, 1e-12);
    if (meets) CHECK_FALSE(part);
    met += meets;
    parted += part;
    CHECK(planes.separates(0, 1, 1e-12, 1e-12) == planes.separates(1, 0, 1e-12, 1e-12));
  }
  CHECK(met > 20);
  CHECK(parted > 20);
}

TEST_CASE("the upper half of a cut block presses on the lower one and does not sink in") {
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
  SampleOptions sampling;
  sampling.spacing = 0.25;
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  Material material;
  material.young = 1e5;
  material.damping = 2;
  Solid solid(body.nodes, body.graph, material);
  State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  SelfContact contact(body, solid);
  auto front = begin_front(std::vector<Vec3>{{-0.3, -0.3, 0.52}, {-0.3, 0.5, 0.53}, {-0.3, 1.3, 0.52}}, false, 1);
  cut(body, solid, state, contact, front, {{1.3, -0.3, 0.47}, {1.3, 0.5, 0.48}, {1.3, 1.3, 0.47}});
  Environment environment;
  environment.gravity = {0, 0, -9.81};
  environment.fixed.assign(solid.size(), 0);
  for (std::size_t i = 0; i < solid.size(); ++i) environment.fixed[i] = body.nodes.position[i].z() < 0.2;
  ContactStats last;
  for (int step = 0; step < 40; ++step) {
    environment.contact.clear();
    ContactStep contact_step = contact.begin_step(body, solid, state, 0.02, environment);
    if (Potential* potential = contact_step.potential()) environment.contact.push_back(potential);
    solid.step_implicit(state, 0.02, environment);
    last = contact.finish_step(std::move(contact_step), solid, state.displacement);
    CHECK(count_crossings(mesh_of(contact)) == 0);
  }
  CHECK(last.touching > 10);
  CHECK(last.tracking_error < 0.2 * contact.surface().edge);
}
