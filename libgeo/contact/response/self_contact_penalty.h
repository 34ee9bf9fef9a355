// Potential of self-contact in an implicit step: a penalty between points of one body's surface,
// with Coulomb friction (§ 3.3).
#pragma once

#include <algorithm>
#include <vector>

#include "contact/response/relative_stencil.h"
#include "kerf/potential.h"
#include "mechanics/terms/contact_law.h"

namespace geo {

/// Friction between the points.
struct SelfContactPenaltyOptions {
  double friction = 0.3;           ///< Coulomb's coefficient
  double slip_regularisation = 0;  ///< model units (contact_law.h)
};

/// The law of contact_law.h for pairs of surface points with a normal that is fixed during the
/// step.
class SelfContactPenalty : public Potential {
 public:
  /// A potential without contacts.
  explicit SelfContactPenalty(const SelfContactPenaltyOptions& options) : options_(options) {}
  /// Removes all contacts; their memory is kept.
  void restart(const SelfContactPenaltyOptions& options) {
    options_ = options;
    contacts_.clear();
    entries_.clear();
  }

  /// Adds a contact. `normal`: unit, from point b of the stencil to point a. `depth`: of
  /// penetration at displacements u, where the step begins, model units; negative: a distance.
  /// `stiffness`: N/m.
  void add(const RelativeStencil& stencil, const Vec3& normal, double depth, double stiffness,
           const std::vector<Vec3>& u) {
    add(stencil, normal, depth, stiffness, weighted_sum(stencil.entries, u));
  }
  /// The same, given the relative displacement at the beginning.
  void add(const RelativeStencil& stencil, const Vec3& normal, double depth, double stiffness, const Vec3& start) {
    const Addition one{.stencil = &stencil, .normal = normal, .depth = depth, .stiffness = stiffness, .start = start};
    add({&one, 1});
  }
  /// A contact as the arguments of add() describe it.
  struct Addition {
    const RelativeStencil* stencil;
    Vec3 normal;
    double depth, stiffness;
    Vec3 start;
  };
  /// Adds contacts in their order.
  void add(std::span<const Addition> contacts);
  /// Number of contacts with a normal force at their last iterate.
  std::size_t pressing() const;

  /// Number of contacts.
  std::size_t size() const override { return contacts_.size(); }
  /// Nodes of a contact's two points.
  Stencil stencil(std::size_t k) const override {
    return {entries_.data() + contacts_[k].first, entries_.data() + contacts_[k].end};
  }
  /// Activation distances hold in substeps that begin where the contacts were added.
  void begin_substep(const std::vector<Vec3>&, double from, double) override {
    at_start_ = from <= 0;
    for (Contact& c : contacts_) c.friction.begin_substep(c.stiffness * std::max(0.0, c.depth), NormalForce::estimated);
  }
  /// Distance of a contact over the norm of its weights.
  double activation_distance(std::size_t k) const override { return at_start_ ? contacts_[k].activation_distance : 0; }
  /// Energy of penalty and friction, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of penalty and friction.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// Takes the bound of friction, and whether the contact presses.
  double begin_iterate(std::size_t k, const Vec3& d) override;

 private:
  struct Contact {
    std::size_t first, end;  // of its entries
    Vec3 normal;
    double depth;                // at the step's beginning, model units
    double stiffness;            // N/m
    double activation_distance;  // of nodes since the step's beginning, model units
    Vec3 start;                  // relative displacement at the step's beginning
    bool pressing = false;       // at the last iterate
    FrictionMemory friction = {};
  };
  LaggedFriction friction(const Contact& c) const {
    return {options_.friction * c.friction.normal_force, options_.slip_regularisation};
  }

  SelfContactPenaltyOptions options_;
  bool at_start_ = false;  // the substep begins where the contacts were added
  std::vector<Contact> contacts_;
  std::vector<NodeWeight> entries_;  // of all stencils, one after the other
};

}  // namespace geo
