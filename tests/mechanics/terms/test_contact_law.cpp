#include "mechanics/terms/contact_law.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"

using namespace geo;

TEST_CASE("the penalty's force and Hessian are derivatives of its energy behind a plane") {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    INFO(i);
    const double k = random.uniform(1, 1e4), offset = random.uniform(0.1, 1);
    const Vec3 n = random.direction(), x = 0.05 * random.direction();
    const auto depth = [&](const Vec3& at) { return offset - n.dot(at); };  // positive near the origin
    const auto energy = [&](const Vec3& at) { return penalty_energy(k, depth(at) * depth(at)); };
    CHECK(penalty_work(k * depth(x), depth(x)) == Approx(energy(x)).epsilon(1e-15));
    const Vec3 d = random.direction();
    const double h = 1e-4;  // central differences of a quadratic function are exact
    const double slope = (energy(x + h * d) - energy(x - h * d)) / (2 * h);
    CHECK(-penalty_force(k, depth(x), n).dot(d) == Approx(slope).epsilon(1e-9).margin(1e-9 * k));
    const double bend = (energy(x + h * d) - 2 * energy(x) + energy(x - h * d)) / (h * h);
    CHECK(d.dot(plane_penalty_hessian(k, n) * d) == Approx(bend).margin(1e-6 * k));
    CHECK(plane_penalty_hessian(k, n).isApprox(penalty_hessian(k, n * n.transpose()), 1e-15));
  }
}

TEST_CASE(
    "friction's force is the derivative of its energy, at most the bound, and its Hessian no less than the true one") {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    INFO(i);
    const LaggedFriction f{random.uniform(0.1, 10), random.uniform(0.01, 1)};
    REQUIRE(f.acts());
    const Vec3 n = random.direction();
    const auto tangential = [&](const Vec3& v) { return Vec3(v - n.dot(v) * n); };
    const Vec3 x = random.uniform(0, 3) * f.slip_regularisation * random.direction();
    const Vec3 s = tangential(x), d = random.direction();
    const auto energy = [&](const Vec3& at) { return f.energy(tangential(at).norm()); };
    Vec3 force = Vec3::Zero();
    Mat3 hessian = Mat3::Zero();
    f.add(s, n * n.transpose(), Vec3::Zero(), force, hessian);
    CHECK(force.norm() <= f.bound * (1 + 1e-14));
    if (s.norm() > f.slip_regularisation) CHECK(force.norm() == Approx(f.bound).epsilon(1e-14));
    CHECK(force.dot(s) <= 0);  // against the slip
    const double h = 1e-5 * f.slip_regularisation;
    const double slope = (energy(x + h * d) - energy(x - h * d)) / (2 * h);
    CHECK(-force.dot(d) == Approx(slope).epsilon(1e-6).margin(1e-6 * f.bound));
    if (std::abs(s.norm() - f.slip_regularisation) < 1e-3 * f.slip_regularisation) continue;  // the Hessian jumps there
    const double wide = 1e-3 * f.slip_regularisation;
    const double bend = (energy(x + wide * d) - 2 * energy(x) + energy(x - wide * d)) / (wide * wide);
    const double secant = d.dot(hessian * d), scale = f.bound / f.slip_regularisation;
    CHECK(secant >= bend - 1e-4 * scale);
    if (s.norm() < 0.99 * f.slip_regularisation) CHECK(secant == Approx(bend).margin(1e-4 * scale));
    CHECK(Eigen::SelfAdjointEigenSolver<Mat3>(hessian).eigenvalues().minCoeff() >= -1e-12 * scale);
  }
  // Energy and force have no jump at the slip regularisation.
  const LaggedFriction f{2, 0.25};
  CHECK(f.energy(0.25) == Approx(f.energy(std::nextafter(0.25, 0.0))).epsilon(1e-14));
  CHECK(f.energy(0.25) == 0.25);
  CHECK_FALSE(LaggedFriction{0, 0.25}.acts());
}

TEST_CASE("friction's Hessian is the true one where a slip has settled, and the secant where it turns back") {
  const LaggedFriction f{2, 0.25};
  const Vec3 n = Vec3::UnitZ(), s(1, 0, 0), across = Vec3::UnitY();
  const auto hessian_after = [&](Vec3 last) {
    Vec3 force = Vec3::Zero();
    Mat3 hessian = Mat3::Zero();
    f.add(s, n * n.transpose(), last, force, hessian);
    CHECK(force == Vec3(-2 * s));
    CHECK(across.dot(hessian * across) == Approx(2));  // b / |s|, which is the true curvature across the slip
    CHECK((hessian * n).norm() < 1e-15);
    return s.dot(hessian * s);
  };
  CHECK(hessian_after(Vec3::Zero()) == Approx(2));  // the first iterate: the secant
  CHECK(hessian_after(s) == Approx(0).margin(1e-15));
  CHECK(hessian_after(0.5 * s) == Approx(0.5));
  CHECK(hessian_after(-s) == Approx(2));
  CHECK(hessian_after(5 * s) == Approx(2));
}

TEST_CASE("friction of an explicit step stops the slip or gives the bound, and impulses act as on the effective mass") {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    INFO(i);
    std::vector<NodeWeight> stencil;
    std::vector<double> inverse_mass;
    std::vector<Vec3> velocity;
    double rest = 0;
    for (std::uint32_t node = 0; node < 5; ++node) {
      const double w = node < 4 ? random.uniform(-1, 1) : -rest;
      rest += w;
      stencil.push_back({node, w});
      inverse_mass.push_back(1 / random.uniform(0.1, 2));
      velocity.push_back(random.direction());
    }
    const double inverse = effective_inverse_mass(stencil, inverse_mass);
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < velocity.size(); ++k) sum += velocity[k] / inverse_mass[k];
      return sum;
    };
    const Vec3 slip = weighted_sum(stencil, velocity), before = momentum();
    const double bound = random.uniform(0, 2) * slip.norm() / inverse;
    const double factor = friction_impulse_factor(bound, slip.norm(), inverse);
    add_impulse(stencil, -factor * slip, inverse_mass, velocity);
    const Vec3 after = weighted_sum(stencil, velocity);
    CHECK((momentum() - before).norm() < 1e-12);  // weights sum to zero
    if (bound < slip.norm() / inverse) {
      CHECK(factor * slip.norm() == Approx(bound).epsilon(1e-12));
      CHECK(after.dot(slip) >= 0);  // does not turn round
    } else {
      CHECK(after.norm() < 1e-12);
    }
  }
}
