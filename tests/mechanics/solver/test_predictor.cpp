// Where Newton's method begins: flights, accelerations, spins and impacts of a bar.
#include "mechanics/solver/predictor.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

// A bar without damping at the beginning of a step.
struct Bar {
  Body body = block_body({0.6, 0.2, 0.2}, 0.1);
  Solid solid;
  State start;
  Environment environment;
  double dt = 0.01;

  explicit Bar(double young) : solid(body, material(young)) {
    start = at_rest(body);
    environment.gravity.setZero();
  }
  std::size_t size() const { return body.nodes.size(); }
  std::vector<Vec3> straight() const {
    std::vector<Vec3> u = start.displacement;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += dt * start.velocity[i];
    return u;
  }
  static Material material(double young) {
    Material m;
    m.young = young;
    m.damping = 0;
    return m;
  }
};

// The prediction of a bar's step, checked: values and forces are those of the potential there.
struct Prediction {
  StepProblem problem;
  IncrementalPotential potential;
  ActiveIslands all;
  NewtonIterate at;

  explicit Prediction(const Bar& bar)
      : problem{SolidDiscretisation::of(bar.solid), bar.start, bar.dt, bar.environment, 1e-3},
        potential(problem),
        all(potential.islands(), SolidDiscretisation::of(bar.solid).subdomains),
        at(predict(potential, FiniteRotation(potential), all)) {
    ElasticResponse response;
    std::vector<double> value;
    std::vector<Vec3> force(at.u.size());
    potential.evaluate(all, at.u, value, &response);
    potential.force(all, at.u, response, force);
    CHECK(value == at.value);
    CHECK(force == at.force);
  }
  Prediction(const Prediction&) = delete;
  double value_at(const std::vector<Vec3>& u) {
    std::vector<double> value;
    potential.evaluate(all, u, value);
    return value[0];
  }
};

}  // namespace

TEST_CASE("a free flight is predicted exactly: velocity, and gravity or the acceleration of the last step",
          "[mechanics]") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Bar bar(1e5);
    const Vec3 velocity = random.direction(), off = random.direction(), acceleration = 20 * random.direction();
    for (std::size_t i = 0; i < bar.size(); ++i) {
      bar.start.displacement[i] = off;
      bar.start.velocity[i] = velocity;
    }
    bar.environment.gravity = 10 * random.direction();
    const Vec3 moved = off + bar.dt * velocity;
    {
      const Prediction unknown(bar);
      for (const Vec3& u : unknown.at.u) CHECK((u - moved - bar.dt * bar.dt * bar.environment.gravity).norm() < 1e-12);
    }
    bar.start.acceleration.assign(bar.size(), acceleration);
    {
      bar.environment.gravity = acceleration;  // as the last step had it
      const Prediction known(bar);
      for (const Vec3& u : known.at.u) CHECK((u - moved - bar.dt * bar.dt * acceleration).norm() < 1e-12);
    }
    // A vibration is not affine, and is left out; so little of it that the search does not lead
    // back.
    bar.environment.gravity.setZero();
    for (Vec3& a : bar.start.acceleration) a = 1e-9 * random.direction();
    const Prediction vibrating(bar);
    CHECK(vibrating.at.u == bar.straight());
  }
}

TEST_CASE("a fast spin begins at its finite rotation, which is below the straight motion and the start",
          "[mechanics]") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Bar bar(std::pow(10.0, random.uniform(6, 9)));
    const Vec3 spin = random.uniform(20, 60) * random.direction(), middle(0.3, 0.1, 0.1);
    for (std::size_t i = 0; i < bar.size(); ++i)
      bar.start.velocity[i] = spin.cross(bar.body.nodes.position[i] - middle);
    Prediction prediction(bar);
    const double value = prediction.at.value[0];
    CHECK(value < prediction.value_at(bar.straight()));
    CHECK(value < prediction.value_at(bar.start.displacement));
    CHECK(bar.solid.energy(prediction.at.u) < 1e-9 * bar.solid.energy(bar.straight()));  // rigid
  }
}

TEST_CASE("where velocities are at odds with each other the beginning is a minimum on the way back to the start",
          "[mechanics]") {
  const auto [first, count] = seeds(10);
  std::size_t back = 0, between = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Bar bar(std::pow(10.0, random.uniform(4, 6.5)));
    for (Vec3& v : bar.start.velocity) v = 1e-4 * random.direction();  // small: the energy is nearly a parabola
    const std::vector<Vec3> straight = bar.straight();
    Prediction prediction(bar);
    // The result is on the line, and a quarter of the way to either side nothing is lower. A share
    // above 0.8 becomes 1: then nothing is lower half way.
    double share = 0, length = 0;
    for (std::size_t i = 0; i < straight.size(); ++i) {
      share += (prediction.at.u[i] - straight[i]).dot(bar.start.displacement[i] - straight[i]);
      length += (bar.start.displacement[i] - straight[i]).squaredNorm();
    }
    share /= length;
    const auto on_line = [&](double s) {
      std::vector<Vec3> u;
      for (std::size_t i = 0; i < straight.size(); ++i)
        u.push_back((1 - s) * straight[i] + s * bar.start.displacement[i]);
      return u;
    };
    const auto there = on_line(share);
    for (std::size_t i = 0; i < there.size(); ++i) CHECK((there[i] - prediction.at.u[i]).norm() < 1e-12);
    const double value = prediction.at.value[0];
    back += prediction.at.u != straight;
    between += share > 0.2 && share < 0.8;
    if (prediction.at.u == straight) continue;  // a shorter way than a fifth is not taken
    CHECK(share > 0.2);
    CHECK(share <= 1 + 1e-9);
    CHECK(value < prediction.value_at(straight));
    const double step = share > 1 - 1e-9 ? 0.5 : 0.25;
    for (const double s : {share - step, share + step})
      if (s > 0 && s < 1) CHECK(value < prediction.value_at(on_line(s)) * (1 + 1e-6));
  }
  CHECK(back > static_cast<std::size_t>(count) / 2);
  CHECK(between > 0);
}
