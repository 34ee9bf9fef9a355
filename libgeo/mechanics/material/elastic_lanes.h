// Elastic energy and stress of many material points in double precision, in vector registers: the
// formulas of elasticity.cpp.
#pragma once

#include <cstddef>
#include <vector>

#include "kerf/material.h"
#include "mechanics/material/point_matrices.h"

namespace geo {

/// Material constants of energies and stresses, Pa.
struct ElasticConstants {
  bool neo_hookean = true;
  double mu = 0, lambda = 0, volume = 0;  ///< neo-Hookean: the reparametrised ones of its own formula
  double viscosity = 0, dt = 1;           ///< Pa·s; the time step, s
  bool yields = false;                    ///< points may have plastic strain
};
/// The constants of a material for a time step of dt seconds.
ElasticConstants elastic_constants(const Material& material, double dt = 1);

/// State of points in addition to ∇u. Null: not present.
struct PointHistory {
  const PointMatrices<double>* relaxation = nullptr;         ///< symmetric: elasticity sees F times it
  const PointMatrices<double>* previous_gradient = nullptr;  ///< ∇u at the start of the step, for viscosity
  const std::vector<double>* share = nullptr;                ///< volume without stress over volume, by prestretch
};

/// Points from `begin` up to `end`, both multiples of eight.
struct PointRange {
  std::size_t begin, end;
};

/// In: ∇u. Out, in place: the first Piola–Kirchhoff stress times `volume`; `energy`: the energy
/// density times `volume`. `volume` and `energy` have one value per point, a multiple of eight of
/// them. Points with zero volume get zeros. `elastic_gradient`, unless null: F times the
/// relaxation, less the identity.
void elastic_response(const ElasticConstants& constants, PointRange range, const std::vector<double>& volume,
                      const PointHistory& history, PointMatrices<double>& gradient, std::vector<double>& energy,
                      PointMatrices<float>* elastic_gradient);

/// Cauchy stress of points with displacement gradient `gradient` and, unless null, a relaxation.
/// Eight numbers per point from stress[8 · point] on: xx, yy, zz, xy, yz, zx in Pa, then 1, then 0.
/// All are zero where det F ≤ 0.
void cauchy_stresses(const ElasticConstants& constants, PointRange range, const PointMatrices<double>* relaxation,
                     const PointMatrices<double>& gradient, float* stress);

}  // namespace geo
