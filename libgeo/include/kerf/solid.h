// A deforming solid, total Lagrangian, with the discrete energy's own forces. Shape functions live
// in material space and change only where a cut passes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/graph.h"
#include "kerf/material.h"
#include "kerf/nodes.h"
#include "mechanics/discretisation/galerkin.h"
#include "mechanics/discretisation/nodal_gradients.h"
#include "mechanics/discretisation/point_lanes.h"
#include "mechanics/solver/node_groups.h"
#include "mechanics/solver/node_patches.h"
#include "mechanics/solver/patch_inverses.h"
#include "mechanics/terms/potential.h"

namespace geo {

struct State {
  std::vector<Vec3> displacement;       ///< per node, model units
  std::vector<Vec3> velocity;           ///< per node, model units per second
  std::vector<Vec3> acceleration = {};  ///< per node, of the step before: Newton begins with them where they are much
                                        // /< the same from node to node; empty: not known
  std::vector<Mat3> plastic = {};       ///< per material point: plastic part of the Green strain; empty: none yet
};

/// What acts on nodes besides elasticity.
struct Environment {
  Vec3 gravity = {0, 0, -9.81};
  bool ground = false;
  Vec3 ground_point = Vec3::Zero(), ground_normal = Vec3::UnitZ();
  double ground_stiffness = 1e4;    ///< per node mass: acceleration per unit of depth, 1/s²
  double friction = 0.5;            ///< share of the tangential velocity that a touching node loses per 0.01 s
  std::vector<double> clearance;    ///< per node: distance to the skin below it; empty: none
  std::vector<std::uint8_t> fixed;  ///< per node: 1 keeps it where it is; empty: none
  std::vector<Vec3> load;           ///< per node: a force, N; empty: none
  std::vector<Potential*> contact;  ///< all of them; none: nothing touches
};

struct StepReport {
  int newton = 0, cg = 0, substeps = 0;
  double energy = 0;  ///< elastic, J, after the step; of the implicit one to second order of what Newton did last
};

/// Nodes and material points by the quality of their moment matrices.
struct MomentQualityCounts {
  std::size_t nodes[3] = {}, points[3] = {}, widened = 0;  ///< by MomentQuality; points whose support had to be widened
};

class Solid {
 public:
  /// From scratch; the discretisation is the materials'. Throws InputError where these are not for
  /// so many nodes.
  Solid(const Body& body, Materials materials);
  /// Of nodes and graph alone, by mueller04 whatever the materials say: there is no surface to clip
  /// cells to.
  Solid(const NodeSet& nodes, const VisibilityGraph& graph, Materials materials);

  /// After a split: what the cut has changed is recomputed; equal to a build from scratch, bit for
  /// bit. New nodes move with their donors' affine map and velocity, and are of their material;
  /// then each connected part gets the rigid motion that gives it back its linear momentum, and its
  /// angular momentum about its centre of mass. Plastic strain stays with its point.
  void update(const Body& body, const BodyDelta& delta, State& state) {
    follow(body, delta, state), settle(body, state);
  }
  /// The two halves of update(): nodes with their motion and gradients, after each split; material
  /// points, once after several and before anything asks about energy, forces or stress.
  void follow(const Body& body, const BodyDelta& delta, State& state);
  void settle(const Body& body, State& state);
  void update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
              std::span<const NodeId> updated, State& state);

  std::size_t size() const { return mass_.size(); }
  double mass(NodeId i) const { return mass_[i.index()]; }
  MomentQuality moment_quality(NodeId i) const { return rows_.quality(i.index()); }
  MomentQualityCounts moment_quality_counts() const;
  const Materials& materials() const { return materials_; }
  const MaterialPoints& points() const { return points_; }
  const NodePatches& patches() const { return patches_; }

  /// ∇u at every node, by moving least squares: exact for linear fields where the moment matrix is
  /// good.
  std::vector<Mat3> gradients(const std::vector<Vec3>& u) const { return rows_.gradients(u); }
  /// gradients(), each with a row of zeros below.
  std::vector<PaddedMat3> gradient_columns(const std::vector<Vec3>& u) const { return rows_.padded_gradients(u); }
  LazyNodalGradients gradients_when_asked(const std::vector<Vec3>& u) const { return {rows_, u}; }
  /// ∇u at node i is Σ u_j g_jᵀ: appends j and g_j (1/m), the node itself included; the g_j sum to
  /// zero.
  void gradient_row(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const;
  /// Elastic energy, J, and forces −∂U/∂u, N; forces sum to zero.
  double energy(const std::vector<Vec3>& u) const;
  std::vector<Vec3> forces(const std::vector<Vec3>& u) const;
  /// −∂²U/∂u² p by the implicit step's own (single precision, positive) stiffness at u.
  std::vector<Vec3> stiffness_product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) const;
  /// Cauchy stress, Pa, about material point x: the mean over material points within `radius`
  /// (those whose segment to x `sees` accepts), weighed by volume and the kernel. Zero where there
  /// are none.
  Mat3 stress_at(const State& state, const Vec3& x, double radius,
                 const std::function<bool(const Vec3&)>& sees = {}) const;

  /// Backward Euler as an incremental potential: Newton, conjugate gradients preconditioned on two
  /// levels, line search. Divided in two halves, and these again, where Newton does not converge.
  /// `accuracy`: of displacements, over the nodes' spacing. One at a time: it keeps what the next
  /// will need as well, which changes nothing but time.
  StepReport step_implicit(State& state, double dt, const Environment& environment, double accuracy = 1e-3) const;
  /// Leapfrog (symplectic Euler) with as many substeps as the fastest wave asks for; twice as many
  /// where the energy rises.
  StepReport step_explicit(State& state, double dt, const Environment& environment) const;

  /// Total linear momentum, and angular momentum about the origin of the world.
  Vec3 momentum(const State& state) const;
  Vec3 angular_momentum(const State& state) const;
  /// Kinetic energy, J.
  double kinetic_energy(const State& state) const;

 private:
  friend class ImplicitStep;
  void follow_nodes(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new,
                    std::span<const NodeId> donors, std::span<const NodeId> updated, State& state, bool parted = true);
  void number_parts(const VisibilityGraph& graph, std::size_t first_new);
  void group_nodes();
  // Of the points that the preconditioner's second level is made of. A cell has four, so that with
  // five it is another of them from cell to cell, and none of every fifth cell: less work, and a
  // step's result is the same to its accuracy.
  std::size_t point_stride() const { return galerkin_ ? 5 : 1; }
  bool flows() const {
    return materials_.any([](const Material& m) { return m.yield > 0; });
  }
  void nodal_points(std::span<const NodeId> updated);
  void update_plasticity(State& state, double dt) const;
  std::vector<PointMatrices<double>> relaxed(const State& state) const;
  double elastic_force(const std::vector<Vec3>& u, std::vector<Vec3>* force,
                       const std::vector<PointMatrices<double>>& relaxed = {}) const;

  Materials materials_;
  std::vector<double> mass_, volume_, spacing_;
  std::vector<Vec3> position_;       // material
  std::vector<std::uint32_t> part_;  // per node: its connected part
  std::uint32_t parts_ = 0;
  NodalGradientOperator rows_;
  NodeGroups groups_;
  NodePatches patches_;
  std::vector<char> other_;         // per node: whether splits have given it another row, or place, since settle()
  mutable PatchInverses inverses_;  // of the last implicit step
  MaterialPoints points_;
  std::optional<Galerkin> galerkin_;
  std::optional<ModePenalty> penalty_;  // of mueller04
};

// ---- How the material about each node has moved, and its stress: for pictures.

/// Displacement of the material at each node, by Eq. 1 from the node and its neighbours. A node's
/// own displacement is a coefficient of that field: where nodes are crowded, as beside cracks, it
/// may be far from what they say together.
std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph,
                                        const State& state);

/// Von Mises' equivalent of the Cauchy stress, Pa, one a node: the mean over material points whose
/// shape functions have the node in them, which see it, weighed by volume and the kernel over the
/// node's support. Plastic strain is taken off; viscosity adds nothing. Zero where no such point
/// can tell.
std::vector<double> von_mises_stress(const Solid& solid, const NodeSet& nodes, const State& state);

}  // namespace geo
