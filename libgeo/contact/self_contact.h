// Self-contact (§ 3.3): the surface of a deforming body, which tracks its nodes by Eq. 1 and never
// crosses itself.
//
// The surface has positions of its own. In each time step forces or impulses keep the nodes apart,
// then the surface moves to its targets, where Eq. 1 puts it, as far as nothing crosses
// (bounded_motion.h). The rest is reported as the tracking error and recovered in later steps.
//
// The two sides of a crack sheet start as coincident vertices, equal to the bit, that move as one.
// They separate along their normals once their targets differ by more than the noise of Eq. 1.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contact/detection/broad_phase.h"
#include "contact/embedding/surface_embedding.h"
#include "contact/response/self_contact_penalty.h"
#include "contact/surface/moving_surface.h"
#include "contact/surface/surface_targets.h"
#include "contact/surface/surface_weights.h"
#include "kerf/contact.h"

namespace geo {

/// Contact of one implicit time step: made by SelfContact::begin_step(), used up by finish_step().
/// It owns the potential that acts in between.
struct ContactStep {
  /// The self-contact forces of the step; null where no parts of the surface can meet.
  Potential* potential() const { return penalty && penalty->size() > 0 ? penalty.get() : nullptr; }

  std::unique_ptr<SelfContactPenalty> penalty;  ///< null: finished
  std::vector<Vec3> tracking_error;             ///< per surface vertex, position less mean target at the beginning
  std::vector<std::uint8_t> still = {};         ///< per surface vertex: 1 where it sleeps; empty: none does
  std::uint64_t revision = 0;                   ///< SelfContact::revision() at the beginning
};

/// Where the surface that a crack step makes will be: made by SelfContact::plan_embedding(), used
/// up by commit().
struct EmbeddingPlan {
  EmbeddedSurface embedding;   ///< the surface after the crack step
  std::uint64_t revision = 0;  ///< SelfContact::revision() when it was planned
};

/// Times of contact that are the same for all parts of a time step which is divided: the energy of
/// what touches would change with them. 0: those of the step.
struct ContactPace {
  double stopping = 0;    ///< s: in which a contact stops what comes at it
  double whole_step = 0;  ///< s: in which half of a separation deficit is made good
};

/// The surface of one body, with self-contact. Not thread-safe.
class SelfContact {
 public:
  /// The surface of a body at rest, without displacement, or at the given positions (per surface
  /// vertex, world) of an earlier run.
  SelfContact(const Body& body, const Solid& solid, const ContactOptions& options = {},
              std::vector<Vec3> positions = {});

  /// Begins an implicit time step of dt seconds at `state`: finds what may touch in it. Uses
  /// gravity, fixed and sleeping nodes of `environment`. The surface of what sleeps stays.
  ContactStep begin_step(const Body& body, const Solid& solid, const State& state, double dt,
                         const Environment& environment, const ContactPace& pace = {});
  /// Moves the surface after the nodes' implicit step, which has ended at `displacement`, per node.
  /// Reads nothing of the body, whose next crack may begin meanwhile. Throws std::logic_error when
  /// the surface has changed since `step` began, or `step` was finished.
  ContactStats finish_step(ContactStep step, const Solid& solid, const std::vector<Vec3>& displacement);
  /// Moves the surface after a step of the nodes in which no contact acted: corrects displacements
  /// and velocities by impulses first. The step began at displacements `before` and took dt
  /// seconds.
  ContactStats finish_step_with_impulses(const Body& body, const Solid& solid, const std::vector<Vec3>& before,
                                         double dt, const std::vector<std::uint8_t>& fixed, State& state);

  /// Positions of the surface that a crack step will turn this one into; `grown`: the complex after
  /// that step. Throws GeometryError when it would cross itself: the crack step must not be
  /// committed then.
  EmbeddingPlan plan_embedding(const Body& body, const Solid& solid, const State& state, const Complex& grown,
                               const CrackDelta& crack) const;
  /// Takes over the surface of a plan after its crack step, `delta`. Throws std::logic_error when
  /// the surface has changed since the plan was made. update_weights() must follow, after one or
  /// several steps.
  void commit(EmbeddingPlan plan, const Body& body, const BodyDelta& delta);
  /// Makes the weights follow the crack steps that were committed. A step that begins does so, too.
  /// `u`: displacements of the nodes.
  void update_weights(const Body& body, const Solid& solid, const std::vector<Vec3>& u);

  /// Sets Coulomb's coefficient of the steps to come.
  void set_friction(double friction) { options_.friction = friction; }

  /// World positions, per surface vertex; unspecified for dead ones.
  const std::vector<Vec3>& positions() const { return surface_.positions(); }
  /// Positions that Eq. 1 gives, per surface vertex, at displacements u of the nodes; valid until
  /// the next call of a method that is not const. Precondition: update_weights().
  const std::vector<Vec3>& targets_at(const std::vector<Vec3>& u) { return targets_.at(weights_, u); }
  /// Eq. 1 as weights of nodes, after update_weights().
  const SurfaceWeights& weights() const { return weights_; }
  /// Triangles and sites.
  const ContactSurface& surface() const { return surface_.topology(); }
  /// Grows with every change of the surface.
  std::uint64_t revision() const { return revision_; }

 private:
  void take_rotations(const Solid& solid, const std::vector<Vec3>& u);
  double gap() const { return options_.gap * surface().edge; }
  std::vector<std::uint8_t> still_vertices(const std::vector<std::uint8_t>& asleep);
  ContactStats move_surface(const std::vector<Vec3>& u, const ContactStep* step);

  ContactOptions options_;
  SurfaceWeights weights_;
  MovingSurface surface_;
  SurfaceTargetCache targets_;
  BroadPhase near_;  // broad phase of the current step; its memory is kept between steps
  std::unique_ptr<SelfContactPenalty> spare_penalty_;  // of a finished step, for its memory
  std::uint64_t revision_ = 0;
};

}  // namespace geo
