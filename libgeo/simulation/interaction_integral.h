// Stress intensities at a crack front by the interaction integral (Yau, Wang and Corten 1980; over
// a domain: Shih and Asaro 1988).
#pragma once

#include <cstddef>
#include <optional>

#include "kerf/body.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"

namespace geo {

/// Integrals over the material points of a body at one time. Refers to its arguments.
class InteractionIntegral {
 public:
  /// For a body and its motion.
  InteractionIntegral(const Body& body, const Solid& solid, const State& motion)
      : body_(body), solid_(solid), motion_(motion) {}

  /// The cylinder that is integrated over.
  struct Domain;

  /// K_I, K_II, K_III at point i of a front, Pa √m, in its tip_frame(). For plane strain, without
  /// plastic strain; with the inertia of the last time step. `rotation`: of the material at the
  /// tip, which is taken off.
  ///
  /// The domain is a cylinder about the front: three node spacings about the tip, and one and a
  /// half to both sides along the front. Nothing within a spacing of the tip counts, where nodes do
  /// not resolve the field. It shrinks where other surfaces are nearer, or the crack is shorter.
  /// Empty where less than one and a half spacings are left, where the crack is not straight for
  /// that length, or where there are too few points.
  std::optional<Vec3> at(const GrowingFront& front, std::size_t i, const Mat3& rotation) const;

 private:
  // The sums over the domain; `factor` makes stress intensities of it.
  struct Sum {
    Vec3 integral = Vec3::Zero(), factor = Vec3::Zero();
    std::size_t points = 0;
  };
  void add_points(const Domain& domain, const Mat3& rotation, Sum& sum) const;
  void add_inertia(const Domain& domain, const Mat3& rotation, double spacing, Sum& sum) const;

  const Body& body_;
  const Solid& solid_;
  const State& motion_;
};

}  // namespace geo
