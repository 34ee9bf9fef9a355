// Conjugate gradients: what a direction may leave, and what moves as a whole.
#include "mechanics/solver/conjugate_gradients.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

Material rubber(double young) {
  Material m;
  m.young = young;
  m.density = 1000;
  return m;
}

// A bar at rest, its potential linearised there.
struct Linearised {
  Body body;
  Solid solid;
  State start;
  Environment environment;
  StepProblem problem;
  IncrementalPotential potential;
  ActiveIslands all;
  SolverCache cache;
  TwoLevelPreconditioner preconditioner;

  Linearised(double young, double dt, double accuracy, double spacing = 0.1, const Vec3& edges = {0.8, 0.3, 0.3})
      : body(block_body(edges, spacing)),
        solid(body, rubber(young)),
        start(at_rest(body)),
        problem{SolidDiscretisation::of(solid), start, dt, environment, accuracy},
        potential(problem),
        all(potential.islands(), SolidDiscretisation::of(solid).subdomains),
        preconditioner(problem, cache) {
    ElasticResponse response;
    std::vector<double> value;
    std::vector<Vec3> force(size());
    potential.evaluate(all, start.displacement, value, &response);
    potential.force(all, start.displacement, response, force);
    potential.linearise(all, response);
    preconditioner.update(potential, start.displacement);
  }
  Linearised(const Linearised&) = delete;
  std::size_t size() const { return body.nodes.size(); }

  NewtonDirection solve(const std::vector<Vec3>& force, bool first, double moved, int& iterations) {
    const std::vector<double> moved_by(potential.islands().count(), moved);
    const std::vector<double> accuracy(potential.islands().count(), problem.accuracy);
    NewtonDirection direction{std::vector<Vec3>(size()), std::vector<double>(potential.islands().count(), 0)};
    iterations = conjugate_gradients(potential, preconditioner, all, force, {first, moved_by, accuracy}, direction);
    return direction;
  }
  // √(r · M⁻¹ r) of r = force − H step, and the largest |M⁻¹ r| in spacings.
  std::pair<double, double> left(const std::vector<Vec3>& force, const std::vector<Vec3>& step) {
    std::vector<Vec3> r(size());
    std::vector<double> curvature;
    potential.multiply(all, step, r, curvature);
    for (std::size_t i = 0; i < size(); ++i) r[i] = force[i] - r[i];
    preconditioner.apply(all, r);
    double product = 0, largest = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const Vec3 z = preconditioner.at(i);
      product += r[i].dot(z);
      largest = std::max(largest, problem.squared_in_spacings(z, i));
    }
    return {std::sqrt(product), std::sqrt(largest)};
  }
};

}  // namespace

TEST_CASE("a body that moves as a whole does so in two iterations", "[mechanics]") {
  const std::uint64_t seed = 31;
  Random random(seed);
  for (int k = 0; k < cases(40); ++k) {
    // Sound passes three to ten spacings in a step.
    const double young = std::pow(10.0, random.uniform(3, 6)),
                 dt = random.uniform(3, 10) * 0.1 * std::sqrt(1e3 / young);
    INFO("seed " << seed << ", case " << k << ": young " << young << ", dt " << dt);
    Linearised bar(young, dt, 1e-4);
    const Vec3 way = 0.009 * 0.1 * random.direction();  // so short that no other direction need follow
    std::vector<Vec3> force(bar.size());
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = bar.problem.solid.mass[i] / (dt * dt) * way;
    int iterations = 0;
    const NewtonDirection direction = bar.solve(force, true, 0, iterations);
    CHECK(iterations <= 2);
    for (const Vec3& d : direction.step) CHECK((d - way).norm() < 0.01 * way.norm());
  }
}

TEST_CASE("a direction ends where its residual is below the accuracy, or at a quarter where another one follows",
          "[mechanics]") {
  const std::uint64_t seed = 32;
  Random random(seed);
  int accurate = 0, early = 0;
  for (int k = 0; k < cases(100); ++k) {
    const double young = std::pow(10.0, random.uniform(2, 6)), accuracy = std::pow(10.0, random.uniform(-4, -2));
    const double dt = 0.01, size = std::pow(10.0, random.uniform(-4, 0));
    const bool first = random.uniform(0, 1) < 0.5;
    INFO("seed " << seed << ", case " << k << ": young " << young << ", accuracy " << accuracy << ", size " << size);
    Linearised bar(young, dt, accuracy);
    const Vec3 way = random.direction();  // of the whole bar
    std::vector<Vec3> force(bar.size());
    for (std::size_t i = 0; i < force.size(); ++i)
      force[i] = size * bar.problem.solid.mass[i] / (dt * dt) * bar.problem.solid.spacing[i] *
                 (way + random.uniform(0, 2) * random.direction());
    int iterations = 0;
    const NewtonDirection direction = bar.solve(force, first, 0, iterations);
    const auto [product, largest] = bar.left(force, direction.step);
    const double initial = bar.left(force, std::vector<Vec3>(bar.size(), Vec3::Zero())).first;
    double length = 0;
    for (std::size_t i = 0; i < bar.size(); ++i)
      length = std::max(length, bar.problem.squared_in_spacings(direction.step[i], i));
    CHECK(iterations > 0);
    CHECK(direction.residual[0] == Approx(largest).epsilon(0.05).margin(1e-3 * accuracy));
    const double rounding = 1.02;
    const bool is_accurate = largest < rounding * 0.5 * accuracy;
    const bool ends_early = length > StepProblem::quadratic_tolerance(accuracy) / rounding &&
                            product < rounding * std::sqrt(0.05) * initial;
    CHECK((is_accurate || ends_early));
    if (is_accurate && first) CHECK((ends_early || product < rounding * std::sqrt(0.3) * initial));
    accurate += is_accurate;
    early += ends_early && !is_accurate;
  }
  CHECK(accurate > 10);
  CHECK(early > 10);
}

// Conjugate gradients end where r · M⁻¹ r is not positive: Newton's method then stood still until
// its last iteration. A small stiff piece moves easily as a whole, so its inverse is
// ill-conditioned.
TEST_CASE("the preconditioner of small stiff pieces is positive definite", "[mechanics]") {
  const std::uint64_t seed = 33;
  Random random(seed);
  for (int k = 0; k < cases(60); ++k) {
    const double young = std::pow(10.0, random.uniform(4, 9)), dt = 0.01;
    const Vec3 size{random.uniform(0.15, 0.3), random.uniform(0.1, 0.2), random.uniform(0.08, 0.1)};
    Linearised piece(young, dt, 1e-4, 0.1, size);
    const auto n = static_cast<Eigen::Index>(piece.size());
    INFO("seed " << seed << ", case " << k << ": young " << young << ", size " << size.transpose() << ", " << n
                 << " nodes");
    Eigen::MatrixXd inverse(3 * n, 3 * n);
    for (Eigen::Index c = 0; c < 3 * n; ++c) {
      std::vector<Vec3> r(piece.size(), Vec3::Zero());
      r[static_cast<std::size_t>(c / 3)][c % 3] = 1;
      piece.preconditioner.apply(piece.all, r);
      for (Eigen::Index i = 0; i < n; ++i)
        inverse.block<3, 1>(3 * i, c) = piece.preconditioner.at(static_cast<std::size_t>(i));
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (inverse + inverse.transpose()));
    CHECK(modes.eigenvalues()[0] > 0);
  }
}

TEST_CASE("accuracy is relative to what forces correct", "[mechanics]") {
  const Linearised bar(1e4, 0.01, 1e-3);
  const auto of = [&](double touched, double correction) { return bar.problem.accuracy_after(touched, correction); };
  CHECK(of(1e-3, 0) == 1e-3);
  CHECK(of(1e-3, 0.1) == Approx(1e-3));
  CHECK(of(1e-3, 0.5) == Approx(5e-3));
  CHECK(of(1e-3, 4) == 0.01);
  CHECK(of(0.03, 4) == 0.03);
  // In contact, by the scene's accuracy of the correction where that is more than ten times
  // gravity's way.
  CHECK(of(1e-6, 1e-4) == 1e-6);
  CHECK(of(1e-6, 0.05) == Approx(5e-5));
  CHECK(of(1e-6, 4) == Approx(4e-3));
}

TEST_CASE("accuracy in contact is a hundredth of gravity's way in a step, at the default", "[mechanics]") {
  const Linearised bar(1e4, 0.01, 1e-3);
  const double way = 0.01 * 0.01 * 9.81;
  CHECK(bar.problem.accuracy_in_contact(0.1) == Approx(0.01 * way / 0.1));
  CHECK(bar.problem.accuracy_in_contact(0) == 1e-3);          // nothing touches
  CHECK(bar.problem.accuracy_in_contact(0.5 * way) == 1e-3);  // the way is longer than a tenth of the spacing
}
