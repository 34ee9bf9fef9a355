// Contact in the loop (§ 3.3): what a scene asks of it, and the surface it keeps.
#pragma once

#include <optional>

#include "body/agreement.h"
#include "contact/ground.h"
#include "contact/self_contact.h"
#include "simulation/scene.h"

namespace geo {

class Collisions {
 public:
  /// `rows`: where the surface is, a row a living surface vertex, ascending, as rows() gives it; empty: at rest. Throws
  /// InputError when there are as many as the body does not have.
  Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& rows);

  /// Before a step: puts the ground's penalty on the surface into the environment, in place of that on nodes.
  void begin(const Body& body, const Solid& solid, const State& motion, double dt, Environment& environment);
  /// What has to agree to a crack step; empty: nothing.
  Agreement agreement(const Body& body, const Solid& solid, const State& motion);
  /// After a crack step that was agreed to, and after a step of nodes that began at displacements `before`.
  void follow(const Body& body, const Solid& solid);
  void resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt, const Environment& environment, State& motion, ContactWork& work);

  /// False: the scene asks for none, and the surface is where Eq. 1 has it.
  bool on() const { return surface_.has_value(); }
  std::vector<Vec3> rows(const Body& body) const;

 private:
  std::optional<SelfContact> surface_;
  std::optional<GroundOptions> ground_options_;  ///< with an acceleration for each depth, 1/s², in place of the pressure
  std::optional<Ground> ground_;
};

}  // namespace geo
