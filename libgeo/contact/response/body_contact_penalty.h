// Surface vertices against triangles of the surface that they are inside of: a penalty between
// deforming bodies, with friction (§ 3.3).
#pragma once

#include "contact/surface/surface_weights.h"
#include "mechanics/terms/potential.h"

namespace geo {

/// ½ k depth² along a direction that is kept during a step, and Coulomb friction as that of an
/// ObstaclePenalty. Both sides get the same force, so that momentum is kept; the angular one to
/// second order of the depth.
class BodyContactPenalty : public Potential {
 public:
  BodyContactPenalty(double friction, double slow) : friction_(friction), slow_(slow) {}

  /// Displacements of the two sides differ by `apart`: weights of nodes, the vertex's less those of
  /// the place on the triangle. `way`: from the place to the vertex at rest. `normal`: out of the
  /// body that the triangle bounds. `stiffness`: N/m.
  void add(std::vector<SurfaceWeights::Entry> apart, const Vec3& way, const Vec3& normal, double stiffness) {
    rows_.push_back({std::move(apart), way, normal, stiffness});
  }
  bool empty() const { return rows_.empty(); }

  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  std::size_t size() const override { return rows_.size(); }
  Stencil stencil(std::size_t k) const override { return rows_[k].apart; }
  double energy(std::size_t k, const Vec3& d) const override;
  Derivatives derivatives(std::size_t k, const Vec3& d) override;
  double stiffness_bound(std::size_t k) const override { return rows_[k].stiffness; }
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  /// The deepest vertex at displacements u; 0: none.
  double depth(const std::vector<Vec3>& u) const;

 private:
  struct Row {
    std::vector<SurfaceWeights::Entry> apart;
    Vec3 way, normal;
    double stiffness;
    double pressed = 0;         // N, when this part of the step began
    Vec3 start = Vec3::Zero();  // how far apart then
    Vec3 at(const std::vector<Vec3>& values) const { return weighted_sum(apart, values); }
    double depth(const Vec3& apart) const { return std::max(0.0, -normal.dot(way + apart)); }
    Vec3 along(const Vec3& v) const { return v - normal.dot(v) * normal; }
  };
  double friction_, slow_;
  std::vector<Row> rows_;
};

}  // namespace geo
