// Contact in the loop (§ 3.3): what a scene asks of it, and the surface it keeps.
#pragma once

#include <optional>

#include "body/agreement.h"
#include "contact/self_contact.h"
#include "kerf/scene.h"

namespace geo {

class Collisions {
 public:
  /// `rows`: where the surface is, a row a living surface vertex, ascending, as rows() gives it; empty: at rest. Throws
  /// InputError when there are as many as the body does not have.
  Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& rows);

  /// Before a step: puts what the surface does to itself into the environment, where the step is implicit.
  void begin(const Body& body, const Solid& solid, const State& motion, double dt, Environment& environment);
  /// What has to agree to a crack step; empty: nothing. `seconds`: what it takes is added.
  Agreement agreement(const Body& body, const Solid& solid, const State& motion, double& seconds);
  /// After a crack step that was agreed to, and after a step of nodes that began at displacements `before`.
  void follow(const Body& body, const Solid& solid, const BodyDelta& delta);
  void resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt,
               const Environment& environment, State& motion, ContactStats& work);

  /// False: the scene asks for none, and the surface is where Eq. 1 has it.
  bool on() const { return surface_.has_value(); }
  std::vector<Vec3> rows(const Body& body) const;
  /// The surface's weights where on(), else nothing.
  const SurfaceWeights* weights() const { return surface_ ? &surface_->weights() : nullptr; }
  /// Where nodes have each surface vertex where on(), else nothing; until the next call of anything.
  std::span<const Vec3> wanted(const Body& body, const State& motion) {
    return surface_ ? std::span<const Vec3>(surface_->targets_at(body, motion.displacement)) : std::span<const Vec3>();
  }

 private:
  std::optional<SelfContact> surface_;
  bool implicit_;
};

}  // namespace geo
