// One time step by backward Euler as an incremental potential (Kane et al. 2000, Li et al. 2020):
// Newton's method with each point's stiffness made positive, conjugate gradients preconditioned on
// two levels, line search on the potential.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "kerf/solid.h"
#include "mechanics/discretisation/block_strain.h"
#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/solver/coarse_motion.h"
#include "mechanics/solver/patch_motion.h"
#include "mechanics/solver/rigid_motion.h"
#include "mechanics/solver/step_parts.h"
#include "mechanics/terms/potential_sum.h"

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
  /// The potential of each part at work at u. `force`, where given: the elastic one; then their
  /// elastic energy and gradients are kept, too.
  void evaluate(const std::vector<Vec3>& u, std::vector<double>& value, std::vector<Vec3>* force);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> couples() const;
  void add_forces(std::vector<Vec3>& force, std::vector<Vec3>& elastic);
  void start(std::vector<double>& value, std::vector<Vec3>& force, std::vector<Vec3>& elastic);
  void go_on();
  void go_back(const std::vector<Vec3>& force, const std::vector<double>& value, std::vector<char>& moved);
  void linearise();
  void precondition();
  void multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out, std::vector<double>& curvature);
  void elastic_product(const std::vector<Vec3>& p);
  Vec3 elastic_at(std::size_t node) const {
    const auto sum = s_.points_.sum_at_node<4>(product_.data(), node);
    return {sum[0], sum[1], sum[2]};
  }
  int solve(const std::vector<Vec3>& force, bool first, std::vector<Vec3>& x, const std::vector<double>& moved,
            std::vector<double>& left);
  void most(const std::vector<Vec3>& moved, std::vector<double>& most) const;
  double squared_in_spacings(const std::vector<Vec3>& moved, std::size_t node) const {
    return moved[node].squaredNorm() / (s_.spacing_[node] * s_.spacing_[node]);
  }
  void take_roots(std::vector<double>& squares) const;  // of parts at work
  // Pieces that nothing holds.
  void find_pieces();
  std::uint32_t piece_of(std::size_t node) const { return parts_.piece_of_nodes()[node]; }
  std::vector<Vec3> gone_round(std::vector<char>& turns) const;
  std::vector<RigidMotion> turning_by(const std::vector<Vec3>& direction) const;
  void keep_momentum(std::vector<Vec3>& direction) const;
  double trusted() const { return std::min(accuracy_, 0.01); }
  Vec3 tangential(const Vec3& d) const { return d - env_.ground_normal.dot(d) * env_.ground_normal; }

  const Solid& s_;
  const State& state_;
  const Environment& env_;
  double dt_, accuracy_;
  std::size_t n_;
  PotentialSum contact_;
  StepParts parts_;
  struct Piece {
    std::uint32_t part = 0;
    double spacing = 1e300;  // the least of its nodes'
  };
  std::vector<Piece> pieces_;
  std::vector<Freedom> freedom_;         // of pieces: what holds or joins them, but for contact
  std::vector<Vec3> u_, target_, load_;  // where it goes by its own inertia; what gravity and loads pull
  std::vector<double> drag_;
  std::vector<Moduli> moduli_;  // per material, of the preconditioner
  BlockStrain strain_;
  std::vector<PointMatrices<double>> relaxed_;  // per block: of plastic strain, where there is any
  std::vector<PointMatrices<double>> before_;   // per block: ∇u at the start, where there is viscosity
  std::vector<PointMatrices<float>> gradient_;  // per block: ∇u of the last evaluation (of F times relaxation, less 1)
  std::vector<StiffnessModes> modes_;
  std::vector<std::vector<float>> weight_;
  std::vector<Mat3> local_;      // what nodes have that acts on nothing else
  std::vector<Mat3> blocks_;     // that and what contact and penalty have for them, as patches_ knows it
  std::vector<double> elastic_;  // per part: energy at its last evaluation
  std::vector<double> energy_;   // per block, of each of its parts
  std::vector<double> pull_;     // what blocks have for their nodes: forces,
  std::vector<float> product_;   // products
  std::optional<PatchMotion> patches_;
  std::optional<CoarseMotion> coarse_;
};

}  // namespace geo
