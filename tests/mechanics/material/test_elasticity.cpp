// Energy, stress and stiffness of one point: finite differences, small-strain limits, and the
// vector versions against the scalar ones.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/error.h"
#include "kerf/material.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/material/plasticity.h"
#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/material/stress_derivative.h"
#include "simd_targets.h"

using namespace geo;

namespace {

Material material(ElasticModel model) {
  Material m;
  m.model = model;
  m.young = 10;
  m.poisson = 0.4;
  m.volume_term = 2;
  return m;
}

Mat3 random_matrix(Random& random, double size) {
  return Mat3::NullaryExpr([&] { return size * random.uniform(-1, 1); });
}

Mat3 random_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
}

double inner(const Mat3& a, const Mat3& b) { return a.cwiseProduct(b).sum(); }

Mat3 reshaped(const Eigen::Matrix<double, 9, 1>& v) { return Eigen::Map<const Mat3>(v.data()); }

void set(PointMatrices<double>& matrices, std::size_t point, const Mat3& m) {
  for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(&matrices.column[c][4 * point]) = m.col(c);
}

Mat3 get(const PointMatrices<double>& matrices, std::size_t point) {
  Mat3 m;
  for (int c = 0; c < 3; ++c) m.col(c) = Eigen::Map<const Vec3>(&matrices.column[c][4 * point]);
  return m;
}

}  // namespace

TEST_CASE("stress is the derivative of the energy density, and its derivative that of the stress", "[elasticity]") {
  const auto model = GENERATE(ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean);
  const Material m = material(model);
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // Strongly deformed, inverted ones included; det F stays off 0, where the energy's formula
    // changes branch.
    const Mat3 f = random_rotation(random) * (Mat3::Identity() + random_matrix(random, 0.7));
    if (std::abs(f.determinant()) < 0.01) continue;
    const Mat3 d = random_matrix(random, 1);
    const double h = 1e-5;
    CHECK((energy_density(m, f + h * d) - energy_density(m, f - h * d)) / (2 * h) ==
          Approx(inner(stress(m, f), d)).epsilon(1e-6).margin(1e-6));
    const Mat3 difference = (stress(m, f + h * d) - stress(m, f - h * d)) / (2 * h);
    const Mat9 hessian = stress_derivative(m, f);
    CHECK((reshaped(hessian * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(d.data())) - difference).norm() <
          1e-6 * (1 + difference.norm()));
    CHECK((hessian - hessian.transpose()).norm() == 0);
  }
}

TEST_CASE("rotations have neither energy nor stress, and small strains see Young's modulus", "[elasticity]") {
  const auto model = GENERATE(ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean);
  Material m = material(model);
  m.volume_term = 0;
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    const Mat3 r = random_rotation(random);
    CHECK(std::abs(energy_density(m, r)) < 1e-14 * m.young);
    CHECK(stress(m, r).norm() < 1e-13 * m.young);
  }
  // Uniaxial tension by hand: lateral contraction ν, stress E · strain.
  const double strain = 1e-6;
  const Mat3 f = Mat3::Identity() + strain * Mat3(Vec3(1, -m.poisson, -m.poisson).asDiagonal());
  CHECK(stress(m, f)(0, 0) == Approx(m.young * strain).epsilon(1e-4));
  CHECK(std::abs(stress(m, f)(1, 1)) < 1e-4 * m.young * strain);
  CHECK(energy_density(m, f) == Approx(0.5 * m.young * strain * strain).epsilon(1e-4));
}

TEST_CASE("the projected derivative is positive semidefinite and keeps non-negative eigenvalues", "[elasticity]") {
  const auto model = GENERATE(ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean);
  const Material m = material(model);
  Random random(5);
  int projected = 0;
  for (int k = 0; k < 100; ++k) {
    const Mat3 f = Mat3::Identity() + random_matrix(random, 0.8);
    const Mat9 full = stress_derivative(m, f), positive = projected_derivative(m, f);
    const Eigen::SelfAdjointEigenSolver<Mat9> eigen(full);
    const Eigen::Matrix<double, 9, 1> expected = eigen.eigenvalues().cwiseMax(0);
    const Eigen::SelfAdjointEigenSolver<Mat9> actual(positive);
    const double scale = eigen.eigenvalues().cwiseAbs().maxCoeff();
    projected += eigen.eigenvalues()[0] < -1e-6 * scale;
    for (int i = 0; i < 9; ++i) CHECK(actual.eigenvalues()[i] == Approx(expected[i]).margin(1e-8 * scale));
  }
  CHECK(projected > 10);
}

TEST_CASE("materials refuse impossible parameters", "[elasticity]") {
  const auto refused = [](auto&& change) {
    Material m;
    change(m);
    CHECK_THROWS_AS(require_material(m), InputError);
  };
  REQUIRE_NOTHROW(require_material(Material{}));
  refused([](Material& m) { m.young = 0; });
  refused([](Material& m) { m.poisson = 0.5; });
  refused([](Material& m) { m.poisson = -1; });
  refused([](Material& m) { m.density = -1; });
  refused([](Material& m) { m.viscosity = -1; });
  refused([](Material& m) { m.max_plastic = std::nan(""); });
  CHECK(Material{}.mu() == Approx(1e5 / 2.6));
  CHECK(Material{}.lambda() == Approx(1e5 * 0.3 / (1.3 * 0.4)));
}

TEST_CASE("points in vector registers with plastic strain and viscosity follow the scalar formulas", "[elasticity]") {
  const auto model = GENERATE(ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean);
  Material m = material(model);
  m.yield = 0.01;
  m.viscosity = 3;
  const double dt = 0.1;
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    constexpr std::size_t points = 16;
    PointMatrices<double> start, inverse_stretch, previous;
    start.resize(points);
    inverse_stretch.resize(points);
    previous.resize(points);
    std::vector<double> volume(points), energy(points);
    for (std::size_t i = 0; i < points; ++i) {
      Mat3 plastic = random_matrix(random, 0.1);
      plastic = 0.5 * (plastic + plastic.transpose()).eval();
      set(start, i, random_matrix(random, 0.3));
      set(previous, i, random_matrix(random, 0.3));
      set(inverse_stretch, i, inverse_plastic_stretch(plastic));
      volume[i] = random.uniform(0.5, 1);
    }
    for_each_simd_target([&] {
      PointMatrices<double> stresses = start;
      elastic_response(elastic_constants(m, dt), {0, points}, volume, {&inverse_stretch, &previous}, stresses, energy,
                       nullptr);
      std::vector<float> cauchy(8 * points);
      cauchy_stresses(elastic_constants(m), {0, points}, &inverse_stretch, start, cauchy.data());
      for (std::size_t i = 0; i < points; ++i) {
        const Mat3 f = Mat3::Identity() + get(start, i), old = Mat3::Identity() + get(previous, i),
                   s = get(inverse_stretch, i);
        const Mat3 rate = 0.5 * (f.transpose() * f - old.transpose() * old) / dt;
        const Mat3 piola = stress(m, f * s) * s + m.viscosity * f * rate;
        const double density = energy_density(m, f * s) + 0.5 * m.viscosity * dt * rate.squaredNorm();
        CHECK(energy[i] == Approx(volume[i] * density).epsilon(1e-10));
        CHECK((get(stresses, i) - volume[i] * piola).norm() < 1e-11 * (1 + piola.norm()));
        const Mat3 elastic = f * s, sigma = stress(m, elastic) * elastic.transpose() / elastic.determinant();
        const float expected[8] = {float(sigma(0, 0)),
                                   float(sigma(1, 1)),
                                   float(sigma(2, 2)),
                                   float(sigma(0, 1)),
                                   float(sigma(1, 2)),
                                   float(sigma(2, 0)),
                                   1,
                                   0};
        for (std::size_t k = 0; k < 8 && elastic.determinant() > 0; ++k)
          CHECK(cauchy[8 * i + k] == Approx(expected[k]).epsilon(1e-5).margin(1e-5 * sigma.norm()));
      }
    });
  }
}
