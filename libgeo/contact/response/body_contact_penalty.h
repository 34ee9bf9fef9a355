// Potential of contact between deforming bodies: a penalty on surface vertices inside another body,
// with Coulomb friction (§ 3.3).
#pragma once

#include <algorithm>
#include <vector>

#include "mechanics/terms/contact_law.h"
#include "mechanics/terms/potential.h"

namespace geo {

/// The law of contact_law.h for a vertex and the point of another body's surface that it is nearest
/// to. The normal is fixed during a step. Forces on both sides are equal and opposite: linear
/// momentum is conserved, the angular one to second order of the depth.
class BodyContactPenalty : public Potential {
 public:
  /// A potential without contacts. `friction`: Coulomb's coefficient; `slip_regularisation`: model
  /// units.
  BodyContactPenalty(double friction, double slip_regularisation)
      : friction_(friction), slip_regularisation_(slip_regularisation) {}

  /// Adds a contact. `stencil`: of the vertex' displacement less that of the surface point.
  /// `offset`: from that point to the vertex at rest. `normal`: unit, out of the body that the
  /// point is on. `stiffness`: N/m.
  void add(std::vector<NodeWeight> stencil, const Vec3& offset, const Vec3& normal, double stiffness) {
    contacts_.push_back({std::move(stencil), offset, normal, stiffness});
  }
  /// Whether there are no contacts.
  bool empty() const { return contacts_.empty(); }

  /// Takes the friction bound and the origin of slip from displacements u.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of contacts.
  std::size_t size() const override { return contacts_.size(); }
  /// Nodes of a contact's vertex and point.
  Stencil stencil(std::size_t k) const override { return contacts_[k].stencil; }
  /// Energy of penalty and friction, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of penalty and friction.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// Takes the bound of friction.
  double begin_iterate(std::size_t k, const Vec3& d) override;
  /// The stiffness of the penalty.
  double stiffness_bound(std::size_t k) const override { return contacts_[k].stiffness; }
  /// The penalty's impulse of an explicit substep; friction stops the slip velocity as far as it
  /// can.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  /// Largest depth of a vertex at displacements u, model units; 0: none is inside.
  double depth(const std::vector<Vec3>& u) const;

 private:
  struct Contact {
    std::vector<NodeWeight> stencil;
    Vec3 offset, normal;
    double stiffness;
    Vec3 start = Vec3::Zero();  // relative displacement when the substep began
    FrictionMemory friction = {};
    /// Depth at relative displacement d; 0 outside.
    double depth(const Vec3& d) const { return std::max(0.0, -normal.dot(offset + d)); }
    /// Part of v across the normal.
    Vec3 tangential(const Vec3& v) const { return v - normal.dot(v) * normal; }
  };
  LaggedFriction friction(const Contact& c) const { return {friction_ * c.friction.normal_force, slip_regularisation_}; }

  double friction_, slip_regularisation_;
  std::vector<Contact> contacts_;
};

}  // namespace geo
