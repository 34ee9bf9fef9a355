// The deformed surface in the time loop, on which all contact acts, and self-contact (§ 3.3) where
// the scene wants the surface kept from crossing itself.
#pragma once

#include <optional>

#include "body/crack_transaction.h"
#include "contact/self_contact.h"
#include "kerf/scene.h"

namespace geo {

/// The surface of the bodies by Eq. 1, and a SelfContact with the scene's options where the scene
/// has it. Without, begin_step() and finish_step() do nothing, and embeddings need no plan.
class Collisions {
 public:
  /// `positions`: of living surface vertices in ascending order, as living_positions() gives them;
  /// empty: at rest. Throws InputError when their number is not that of the body.
  Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& positions);

  /// Begins a time step of dt seconds; adds the potential of an implicit one to `environment`. The
  /// result owns that potential, and is empty for explicit steps. `pace`: see
  /// SelfContact::begin_step().
  std::optional<ContactStep> begin_step(const Body& body, const Solid& solid, const State& motion, double dt,
                                        const ContactPace& pace, Environment& environment);
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
  /// Makes the surface's weights follow the crack steps and the rotations of debris. The first call
  /// costs a pass over the surface, others follow the cuts.
  void update_weights(const Body& body, const Solid& solid, const State& motion);

  /// Sets Coulomb's coefficient of the steps to come.
  void set_friction(double friction) {
    if (surface_) surface_->set_friction(friction);
  }

  /// Whether the scene has self-contact; otherwise the surface is where Eq. 1 has it.
  bool on() const { return surface_.has_value(); }
  /// World positions of living surface vertices in ascending order; empty without self-contact.
  std::vector<Vec3> living_positions(const Body& body) const;
  /// The surface's weights, after update_weights().
  const SurfaceWeights& weights() const { return surface_ ? surface_->weights() : weights_; }
  /// Targets of surface vertices (Eq. 1), after update_weights(). Valid until the next call of a
  /// method that is not const.
  const std::vector<Vec3>& targets(const State& motion) {
    return surface_ ? surface_->targets_at(motion.displacement) : targets_.at(weights_, motion.displacement);
  }

 private:
  std::optional<SelfContact> surface_;
  SurfaceWeights weights_;      // without self-contact; empty before the first update_weights()
  SurfaceTargetCache targets_;  // of these
  bool implicit_;               // steps of the scene
};

}  // namespace geo
