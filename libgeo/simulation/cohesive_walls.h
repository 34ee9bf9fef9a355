// Cohesive tractions between the sides of glued walls that have broken, until the energy of the new
// surfaces is spent (Camacho and Ortiz 1996, with equal weights of opening and sliding).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contact/surface/surface_weights.h"
#include "kerf/body.h"
#include "kerf/glue.h"
#include "kerf/material.h"
#include "kerf/potential.h"

namespace geo {

/// The traction over the opening δ of two sides. It rises linearly to its peak at first, and then
/// falls linearly to zero at `opening`; where the sides come back, it falls linearly to zero with
/// them. The area below it, ½ peak · opening, is the energy of a unit of area.
struct CohesiveLaw {
  double peak = 0;     ///< Pa
  double opening = 0;  ///< at which nothing holds, model units; 0: there is no traction

  /// Share of `opening` at which the traction has its peak.
  static constexpr double rise = 0.1;
  /// The law of a bond that breaks at the traction `limit`, Pa, with the energy of its toughness
  /// for plane strain, G = K² (1 − ν²) / E (Irwin 1957). Where time steps of dt seconds would pass
  /// over the opening, the opening is longer and the peak lower, for the same energy.
  static CohesiveLaw of(const GluedBond& bond, double limit, const Material& material, double dt);
  /// The largest opening so far that the law begins with, model units.
  double first() const { return rise * opening; }
  /// The traction where the opening is the largest so far, Pa.
  double traction(double reached) const;
  /// The energy that is spent, J per square model unit, where the largest opening so far is
  /// `reached`. The rest of the work comes back.
  double spent(double reached) const;
  /// The energy of an opening δ, spent energy since `reached` included, J per square model unit.
  double energy(double delta, double reached) const;
  /// The traction over the opening δ, Pa per model unit.
  double secant(double delta, double reached) const;
};

/// The potential of these tractions in a time step. Each living face of a broken wall has a point
/// on each side.
class CohesiveWalls : public Potential {
 public:
  /// Begins a time step. Finds the faces of all walls that hold yet, if the body has changed since
  /// the last call. `weights`: of the body's surface, up to date.
  void begin_step(const Body& body, const GluedBonds& glued, const SurfaceWeights& weights);
  /// Ends a time step at displacements u: remembers the openings. Returns the energy spent, J.
  double end_step(const std::vector<Vec3>& u, GluedBonds& glued);
  /// Whether no wall holds.
  bool empty() const { return terms_.empty(); }

  /// Openings reached in earlier substeps count.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of faces.
  std::size_t size() const override { return terms_.size(); }
  /// The nodes on both sides of a face.
  Stencil stencil(std::size_t k) const override { return terms_[k].stencil; }
  /// The energy of an opening, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// With the secant stiffness across the opening, and along it where it is not the largest so far.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// The stiffness before the peak, N/m.
  double stiffness_bound(std::size_t k) const override;
  /// The impulse of the traction.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

 private:
  struct Face {
    FaceId face;
    std::uint32_t bond, of;  // of the bond, and the bond's face that it is a part of
    double area;
  };
  struct Term {
    std::vector<NodeWeight> stencil;
    Vec3 offset;  // of the opening that rotations of debris add
    CohesiveLaw law;
    double area;
    double before, reached;  // largest opening: before the step, and before the substep
    Face at;
  };
  static std::vector<Face> faces_of(const Body& body, const GluedBonds& glued);
  void add_term(const Face& at, const Body& body, const GluedBonds& glued, const SurfaceWeights& weights);

  std::vector<Term> terms_;
  std::uint32_t crack_steps_ = ~0u;  // of the body, when terms_ were made
};

}  // namespace geo
