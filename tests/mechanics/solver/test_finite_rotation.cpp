// Finite rotations of free-floating islands: a cut block whose two halves turn, or are held.
#include "mechanics/solver/finite_rotation.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

// A bar cut in two, in a step that begins at random displacements of whole halves. One half may
// have a fixed node.
struct Halves {
  Body body;
  Solid solid;
  State start;
  Environment environment;
  bool held;

  explicit Halves(Random& random) : body(block_body({1, 0.3, 0.3}, 0.1)), solid((cut(body), Solid(body, material()))) {
    const std::size_t n = solid.size();
    start = {std::vector<Vec3>(n), std::vector<Vec3>(n)};
    held = random.below(2) == 0;
    if (held) {
      environment.fixed.assign(n, 0);
      for (std::size_t i = 0; i < n; ++i)
        if (half(i) == 0) {
          environment.fixed[i] = 1;
          i = n;
        }
    }
    const Vec3 off = random.direction(), velocity = random.direction(), spin = 3 * random.direction();
    const Mat3 turn = turned(random.uniform(0, 3) * random.direction());
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& x = body.nodes.position[i];
      start.displacement[i] = turn * x + off - x;
      start.velocity[i] = velocity + spin.cross(x) + 0.1 * random.direction();
      environment.load.push_back(0.1 * random.direction());
    }
  }
  StepProblem problem() const { return {SolidDiscretisation::of(solid), start, 0.02, environment, 1e-3}; }
  // Which half a node is in; the left one is 0.
  std::size_t half(std::size_t i) const { return body.nodes.position[i].x() < 0.5 ? 0 : 1; }
  bool is_free(std::size_t i) const { return !held || half(i) == 1; }
  Vec3 position(std::size_t i, const std::vector<Vec3>& u) const { return body.nodes.position[i] + u[i]; }

  static Material material() {
    Material m;
    m.damping = 0;
    return m;
  }
  static void cut(Body& body) {
    FrontState front = begin_front(std::vector<Vec3>{{0.5, -0.1, 0.4}, {0.5, 0.4, 0.4}}, false, 1);
    split(body, front, std::vector<Vec3>{{0.5, -0.1, -0.1}, {0.5, 0.4, -0.1}});
  }
  static Mat3 turned(const Vec3& by) {
    return by.norm() > 0 ? Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix() : Mat3(Mat3::Identity());
  }
};

// A step of the halves, and the rotation of its islands.
struct Turning {
  explicit Turning(Random& random) : halves(random) {}
  const Halves halves;
  const StepProblem problem = halves.problem();
  const IncrementalPotential potential{problem};
  const FiniteRotation rotation{potential};
};

}  // namespace

TEST_CASE("islands that turn are predicted on arcs: rigid motions are exact, and others keep all distances",
          "[mechanics]") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Turning turning(random);
    const auto& [halves, problem, potential, rotation] = turning;
    REQUIRE(potential.islands().free_count() == 2);
    const std::size_t n = halves.solid.size();
    std::vector<char> rotates;
    // Each half turns and moves by itself.
    const Mat3 turn[2] = {Halves::turned(random.uniform(0.1, 1.5) * random.direction()),
                          Halves::turned(random.uniform(0.1, 1.5) * random.direction())};
    const Vec3 off[2] = {random.direction(), random.direction()};
    std::vector<Vec3> u(n), noisy(n), shifted(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t h = halves.half(i);
      u[i] = turn[h] * halves.position(i, halves.start.displacement) + off[h] - halves.body.nodes.position[i];
      noisy[i] = u[i] + 0.02 * random.direction();
      shifted[i] = halves.start.displacement[i] + off[h];
    }
    const auto exact = rotation.predict(u, rotates);
    REQUIRE(exact.size() == n);
    for (std::size_t i = 0; i < n; ++i) {
      CHECK((exact[i] - (halves.is_free(i) ? u[i] : halves.start.displacement[i])).norm() < 1e-9);
      CHECK(rotates[potential.islands().of(i)] == (halves.is_free(i) ? 1 : 0));
    }
    const auto rigid = rotation.predict(noisy, rotates);
    REQUIRE(rigid.size() == n);
    double residual = 0, wrong = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = random.below(static_cast<std::uint32_t>(n));
      if (halves.half(i) == halves.half(j))
        CHECK(
            (halves.position(i, rigid) - halves.position(j, rigid)).norm() ==
            Approx(
                (halves.position(i, halves.start.displacement) - halves.position(j, halves.start.displacement)).norm())
                .margin(1e-9));
      if (!halves.is_free(i)) continue;
      const double mass = halves.solid.mass(NodeId(static_cast<std::uint32_t>(i)));
      residual += mass * (rigid[i] - noisy[i]).squaredNorm();
      wrong += mass * (u[i] - noisy[i]).squaredNorm();
    }
    CHECK(residual <= wrong * (1 + 1e-9));  // the nearest rigid motion is no farther than the true one
    CHECK(rotation.predict(shifted, rotates).empty());
    CHECK(std::count(rotates.begin(), rotates.end(), 0) == static_cast<std::ptrdiff_t>(rotates.size()));
  }
}

TEST_CASE("a direction gets the momenta that inertia and loads alone give, and a held island keeps its own",
          "[mechanics]") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Turning turning(random);
    const auto& [halves, problem, potential, rotation] = turning;
    const ActiveIslands active(potential.islands(), SolidDiscretisation::of(halves.solid).subdomains);
    const std::size_t n = halves.solid.size();
    std::vector<Vec3> u = halves.start.displacement, direction(n);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] += 0.02 * random.direction();
      direction[i] = 0.1 * random.direction();
    }
    const std::vector<Vec3> before = direction;
    rotation.conserve_momentum(active, u, direction);
    Vec3 linear[2] = {Vec3::Zero(), Vec3::Zero()}, angular[2] = {Vec3::Zero(), Vec3::Zero()},
         linear_before = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const double mass = halves.solid.mass(NodeId(static_cast<std::uint32_t>(i)));
      // Without damping ũ = u₀ + Δt v₀; gravity and loads accelerate.
      const Vec3 ballistic = halves.start.displacement[i] + problem.dt * halves.start.velocity[i] +
                             problem.dt * problem.dt * (halves.environment.gravity + halves.environment.load[i] / mass);
      const Vec3 missing = mass * (ballistic - u[i] - direction[i]);
      linear[halves.half(i)] += missing;
      angular[halves.half(i)] += halves.position(i, u).cross(missing);
      if (halves.half(i) == 1) linear_before += mass * (ballistic - u[i] - before[i]);
      if (!halves.is_free(i)) CHECK(direction[i] == before[i]);
    }
    CHECK(linear_before.norm() > 1e-3);
    for (const std::size_t h : {0u, 1u}) {
      if (h == 0 && halves.held) continue;
      CHECK(linear[h].norm() < 1e-9);
      CHECK(angular[h].norm() < 1e-9);
    }
  }
}

TEST_CASE("rotations are those of directions, zero where they are negligible, and mark their islands", "[mechanics]") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Turning turning(random);
    const auto& [halves, problem, potential, rotation] = turning;
    const std::vector<Vec3>& u = halves.start.displacement;
    // The right half turns by an angle at first order; the left one by next to nothing.
    const Vec3 angle = random.uniform(0.1, 0.5) * random.direction(), off = random.direction();
    std::vector<Vec3> direction(halves.solid.size());
    for (std::size_t i = 0; i < direction.size(); ++i)
      direction[i] = off + (halves.half(i) == 1 ? 1.0 : 1e-6) * angle.cross(halves.position(i, u));
    const auto found = rotation.rotations(u, direction);
    REQUIRE(found.size() == 2);
    for (std::size_t i = 0; i < direction.size(); ++i) {
      const RigidMotion& motion = found[rotation.island_of(i)];
      if (halves.half(i) == 0) {
        CHECK(motion.angle == Vec3(Vec3::Zero()));
        CHECK(motion.translation == Vec3(Vec3::Zero()));
      } else {
        CHECK((motion.angle - angle).norm() < 1e-9);
        CHECK((motion.linearised(halves.position(i, u)) - direction[i]).norm() < 1e-9);
      }
    }
    std::vector<char> rotates(potential.islands().count(), 0);
    rotation.mark_rotating(found, rotates);
    for (std::size_t i = 0; i < direction.size(); ++i)
      CHECK(rotates[potential.islands().of(i)] == (halves.half(i) == 1 ? 1 : 0));
  }
}
