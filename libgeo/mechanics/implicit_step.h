// One time step by backward Euler as an incremental potential (Kane et al. 2000, Li et al. 2020): Newton's method with each
// point's stiffness made positive, conjugate gradients preconditioned on two levels, line search on the potential.
#pragma once

#include <optional>
#include <vector>

#include "base/parallel.h"
#include "mechanics/coarse_motion.h"
#include "mechanics/patch_motion.h"
#include "mechanics/solid.h"
#include "mechanics/stiffness_lanes.h"

namespace geo {

class ImplicitStep {
 public:
  /// From `state` on; refers to all that it is given.
  ImplicitStep(const Solid& solid, const State& state, double dt, const Environment& env, double accuracy);
  /// True where Newton converged: then displacement() is that after the step.
  bool run(StepReport& report);
  const std::vector<Vec3>& displacement() const { return u_; }
  /// The stiffness alone at u times p.
  std::vector<Vec3> product(const std::vector<Vec3>& u, const std::vector<Vec3>& p);

 private:
  /// The potential at u; its elastic energy and gradients are kept. `force`, where given: the elastic one.
  double evaluate(const std::vector<Vec3>& u, std::vector<Vec3>* force);
  void linearise();
  void precondition();
  void multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out);
  void elastic_product(const std::vector<Vec3>& p, std::vector<float>& parts) const;
  int solve(const std::vector<Vec3>& force, std::vector<Vec3>& x, double small);
  double most(const std::vector<Vec3>& moved) const;
  void keep_momentum(std::vector<Vec3>& direction) const;
  Vec3 tangential(const Vec3& d) const { return d - env_.ground_normal.dot(d) * env_.ground_normal; }
  static double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b);
  template <class Work>
  void each_node(const Work& work) const {
    parallel_for(n_, 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  }

  const Solid& s_;
  const State& state_;
  const Environment& env_;
  double dt_, accuracy_;
  std::size_t n_;
  std::vector<Mat3> relaxed_;
  std::vector<Vec3> u_, target_, load_;  // where it goes by its own inertia; what gravity and loads pull
  std::vector<double> drag_;
  std::vector<std::vector<Mat3>> before_;       // per block: F at the start, where there is viscosity
  std::vector<Columns<float>> gradient_;        // per block: ∇u of the last evaluation (of F times relaxation, less 1)
  std::vector<StiffnessModes> modes_;
  std::vector<std::vector<float>> weight_;
  std::vector<Mat3> local_;  // what nodes have that acts on nothing else
  double elastic_ = 0;  // energy at the last evaluation
  std::vector<float> parts_;
  std::optional<PatchMotion> patches_;
  std::optional<CoarseMotion> coarse_;
};

}  // namespace geo
