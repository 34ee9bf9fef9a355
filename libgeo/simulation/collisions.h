// Self-contact in the time loop (§ 3.3): the surface of the bodies, where the scene wants it kept
// from crossing itself.
#pragma once

#include <optional>

#include "body/veto.h"
#include "contact/self_contact.h"
#include "kerf/scene.h"

namespace geo {

/// Adapts a SelfContact to the scene's options; without self-contact all methods do nothing.
class Collisions {
 public:
  /// `positions`: of living surface vertices in ascending order, as living_positions() gives them;
  /// empty: at rest. Throws InputError when their number is not that of the body.
  Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& positions);

  /// Begins a time step of dt seconds; adds the potential of an implicit one to `environment`. The
  /// result owns that potential, and is empty for explicit steps.
  std::optional<ContactStep> begin_step(const Body& body, const Solid& solid, const State& motion, double dt,
                                        Environment& environment);
  /// Moves the surface after a step that begin_step() began at displacements `before`; in explicit
  /// steps changes `motion` by impulses.
  ContactStats finish_step(std::optional<ContactStep> step, const Body& body, const Solid& solid,
                           const std::vector<Vec3>& before, double dt, const Environment& environment, State& motion);

  /// A check of a crack step before its commit: plans the embedding of its surface into `plan`, and
  /// adds its time to `seconds`. Refers to all arguments. Empty without self-contact.
  StepVeto embedding_check(const Body& body, const Solid& solid, const State& motion,
                           std::optional<EmbeddingPlan>& plan, double& seconds);
  /// Updates the surface after a crack step, by the plan of its embedding_check(). Throws
  /// std::logic_error if the step cut something and there is no plan.
  void commit(std::optional<EmbeddingPlan> plan, const Body& body, const BodyDelta& delta);
  /// Makes the surface's weights follow the crack steps.
  void update_weights(const Body& body, const Solid& solid) {
    if (surface_) surface_->update_weights(body, solid);
  }

  /// Sets Coulomb's coefficient of the steps to come.
  void set_friction(double friction) {
    if (surface_) surface_->set_friction(friction);
  }

  /// Whether the scene has self-contact; otherwise the surface is where Eq. 1 has it.
  bool on() const { return surface_.has_value(); }
  /// World positions of living surface vertices in ascending order; empty without self-contact.
  std::vector<Vec3> living_positions(const Body& body) const;
  /// The surface's weights, after update_weights(); null without self-contact.
  const SurfaceWeights* weights() const { return surface_ ? &surface_->weights() : nullptr; }
  /// Targets of surface vertices (Eq. 1), after update_weights(). Valid until the next call of a
  /// method that is not const; empty without self-contact.
  std::span<const Vec3> targets(const State& motion) {
    return surface_ ? std::span<const Vec3>(surface_->targets_at(motion.displacement)) : std::span<const Vec3>();
  }

 private:
  std::optional<SelfContact> surface_;
  bool implicit_;  // steps of the scene
};

}  // namespace geo
