// Energies of kerf/material.h, their derivatives of stress_derivative.h. Saint-Venant–Kirchhoff,
// and the stable neo-Hookean energy of Smith, de Goes and Kim (2018), which is defined for inverted
// elements, too. Notation: F deformation gradient, J = det F, E = ½ (FᵀF − 1), I = tr FᵀF.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "kerf/error.h"
#include "mechanics/material/stress_derivative.h"

namespace geo {
namespace {

Mat3 cofactor(const Mat3& f) {
  Mat3 c;
  c.col(0) = f.col(1).cross(f.col(2));
  c.col(1) = f.col(2).cross(f.col(0));
  c.col(2) = f.col(0).cross(f.col(1));
  return c;
}

// Directional derivative of the cofactor matrix.
Mat3 cofactor_derivative(const Mat3& f, const Mat3& d) {
  Mat3 c;
  c.col(0) = d.col(1).cross(f.col(2)) + f.col(1).cross(d.col(2));
  c.col(1) = d.col(2).cross(f.col(0)) + f.col(2).cross(d.col(0));
  c.col(2) = d.col(0).cross(f.col(1)) + f.col(0).cross(d.col(1));
  return c;
}

// Reparametrisation of Smith et al. 2018, § 3.4: at small strain, the energy has Lamé's constants.
struct StableConstants {
  double mu, lambda, alpha;
  explicit StableConstants(const Material& m)
      : mu(4.0 / 3.0 * m.mu()), lambda(m.lambda() + 5.0 / 6.0 * m.mu()), alpha(1 + 0.75 * mu / lambda) {}
};

// Directional derivative of the stress.
Mat3 stress_differential(const Material& m, const Mat3& f, const Mat3& d) {
  const Mat3 cof = cofactor(f), dcof = cofactor_derivative(f, d);
  const double j = f.determinant(), dj = (cof.array() * d.array()).sum();
  Mat3 result = m.volume_term * (dj * cof + (j - 1) * dcof);
  if (m.model == ElasticModel::saint_venant_kirchhoff) {
    const Mat3 e = 0.5 * (f.transpose() * f - Mat3::Identity()), de = 0.5 * (d.transpose() * f + f.transpose() * d);
    const Mat3 s = 2 * m.mu() * e + m.lambda() * e.trace() * Mat3::Identity(),
               ds = 2 * m.mu() * de + m.lambda() * de.trace() * Mat3::Identity();
    return result + d * s + f * ds;
  }
  const StableConstants p(m);
  const double i = f.squaredNorm(), di = 2 * (f.array() * d.array()).sum();
  result += p.mu * (1 - 1 / (i + 1)) * d + p.mu * di / ((i + 1) * (i + 1)) * f;
  return result + p.lambda * (dj * cof + (j - p.alpha) * dcof);
}

}  // namespace

void require_material(const Material& m) {
  if (!(m.young > 0) || !std::isfinite(m.young)) throw InputError("Young's modulus must be positive");
  if (!(m.poisson > -1 && m.poisson < 0.5)) throw InputError("Poisson's ratio must lie between -1 and 0.5");
  if (!(m.density > 0) || !std::isfinite(m.density)) throw InputError("the density must be positive");
  if (!(m.volume_term >= 0) || !(m.damping >= 0) || !(m.viscosity >= 0) || !(m.mode_penalty >= 0))
    throw InputError("volume term, damping, viscosity and mode penalty must not be negative");
  if (!(m.yield >= 0) || !(m.creep >= 0) || !(m.max_plastic >= 0))
    throw InputError("yield, creep and the largest plastic strain must not be negative");
}

// Invariants of the Green strain avoid cancellation near rigid motions: the energy's terms of first
// order must cancel. With e = tr E and J² = det(1 + 2 E), J − 1 (`volume_strain`) and e − (J − 1)
// (`remainder`, of second order) are computed without subtracting 1.
double energy_density(const Material& m, const Mat3& f) {
  const Mat3 strain = 0.5 * (f.transpose() * f - Mat3::Identity());
  const double e = strain.trace(), j = f.determinant();
  const double minors = 0.5 * (e * e - strain.squaredNorm()), cubic = strain.determinant();
  const double volume_strain = j > 0 ? (2 * e + 4 * minors + 8 * cubic) / (j + 1) : j - 1;
  double energy = 0.5 * m.volume_term * volume_strain * volume_strain;
  if (m.model == ElasticModel::saint_venant_kirchhoff)
    return energy + m.mu() * strain.squaredNorm() + 0.5 * m.lambda() * e * e;
  const StableConstants p(m);
  const double remainder = j > 0 ? (e * volume_strain - 4 * minors - 8 * cubic) / (j + 1) : e - volume_strain;
  return energy + 0.75 * p.mu * remainder + 0.5 * p.lambda * volume_strain * volume_strain +
         0.5 * p.mu * (0.5 * e - std::log1p(0.5 * e));
}

Mat3 stress(const Material& m, const Mat3& f) {
  const Mat3 cof = cofactor(f);
  const double j = f.determinant();
  const Mat3 result = m.volume_term * (j - 1) * cof;
  if (m.model == ElasticModel::saint_venant_kirchhoff) {
    const Mat3 e = 0.5 * (f.transpose() * f - Mat3::Identity());
    return result + f * (2 * m.mu() * e + m.lambda() * e.trace() * Mat3::Identity());
  }
  const StableConstants p(m);
  return result + p.mu * (1 - 1 / (f.squaredNorm() + 1)) * f + p.lambda * (j - p.alpha) * cof;
}

Mat9 stress_derivative(const Material& m, const Mat3& f) {
  Mat9 h;
  for (int c = 0; c < 9; ++c) {
    Mat3 d = Mat3::Zero();
    d.data()[c] = 1;
    const Mat3 s = stress_differential(m, f, d);
    h.col(c) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(s.data());
  }
  return 0.5 * (h + h.transpose());
}

StiffnessConstants stiffness_constants(const Material& m) {
  if (m.model == ElasticModel::saint_venant_kirchhoff)
    return {.neo_hookean = false,
            .mu = float(m.mu()),
            .lambda = float(m.lambda()),
            .alpha = 1,
            .volume = float(m.volume_term),
            .viscous = 0};
  const StableConstants p(m);
  return {.neo_hookean = true,
          .mu = float(p.mu),
          .lambda = float(p.lambda),
          .alpha = float(p.alpha),
          .volume = float(m.volume_term),
          .viscous = 0};
}

// A Cholesky factorisation that succeeds proves that no eigenvalue is below −1e-9 of the diagonal,
// and spares their computation.
Mat9 projected_derivative(const Material& m, const Mat3& f) {
  const Mat9 h = stress_derivative(m, f);
  if (Eigen::LLT<Mat9>(h + 1e-9 * h.diagonal().cwiseAbs().maxCoeff() * Mat9::Identity()).info() == Eigen::Success)
    return h;
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace geo
