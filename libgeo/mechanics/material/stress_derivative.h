// Derivatives of the hyperelastic stress, and material constants of the implicit solver.
#pragma once

#include <Eigen/Core>

#include "kerf/material.h"

namespace geo {

/// A matrix between deformation gradients that are vectorised column by column.
using Mat9 = Eigen::Matrix<double, 9, 9>;

/// ∂²Ψ/∂F², Pa.
Mat9 stress_derivative(const Material& material, const Mat3& f);
/// stress_derivative() with its negative eigenvalues set to zero, for Newton's method.
Mat9 projected_derivative(const Material& material, const Mat3& f);

/// Material constants of the stiffness in single precision, Pa (stiffness_lanes.h). For the stable
/// neo-Hookean energy, μ, λ and α are the reparametrised ones.
struct StiffnessConstants {
  bool neo_hookean = true;
  float mu = 0, lambda = 0, alpha = 1, volume = 0;
  float viscous = 0;  ///< η/Δt: stiffness of the symmetric displacement gradient by viscosity, at small strain
};
/// The constants of a material, without viscosity.
StiffnessConstants stiffness_constants(const Material& material);

/// Shear and bulk modulus of an isotropic small-strain stiffness, Pa.
struct Moduli {
  float shear = 0, bulk = 0;
  /// True if both moduli are equal.
  friend bool operator==(const Moduli&, const Moduli&) = default;
};

}  // namespace geo
