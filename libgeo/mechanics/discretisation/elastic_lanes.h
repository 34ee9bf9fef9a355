// Elastic energy and stress of material points in double precision, eight points side by side: the formulas of
// elasticity.h.
#pragma once

#include "kerf/material.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {

/// What energies need of a material.
struct ElasticConstants {
  bool neo_hookean = true;
  double mu = 0, lambda = 0, volume = 0;  ///< of a neo-Hookean material, those of its own formula
  double viscosity = 0, dt = 1;
  bool flows = false;  ///< its points may have plastic strain
};
ElasticConstants elastic_constants(const Material& material, double dt = 1);

/// Points of which more is known than ∇u. Null where there is nothing.
struct PointHistory {
  const Columns<double>* relaxed =
      nullptr;  ///< F is times this symmetric matrix before it meets the material, and stress after
  const Columns<double>* before = nullptr;  ///< ∇u one time step ago, for viscosity
};

/// From point `begin` to `end`, both multiples of eight: ∇u becomes the first Piola–Kirchhoff stress times `volume`;
/// `energy`: the density times it. `volume` and `energy`: one a point, a multiple of eight of them; where the volume is
/// zero, so is all else. `deformed`, where given: F (relaxed) less 1.
void elastic_points(const ElasticConstants& constants, std::size_t begin, std::size_t end,
                    const std::vector<double>& volume, const PointHistory& history, Columns<double>& gradient,
                    std::vector<double>& energy, Columns<float>* deformed);

/// From point `begin` to `end`, both multiples of eight: of ∇u and, where given, `relaxed` as above, eight numbers a
/// point from own[8 · point] on: the Cauchy stress, Pa (xx, yy, zz, xy, yz, zx), 1 and 0; all are zero where F is not
/// upright.
void cauchy_stresses(const ElasticConstants& constants, std::size_t begin, std::size_t end,
                     const Columns<double>* relaxed, const Columns<double>& gradient, float* own);

}  // namespace geo
