// A deforming solid: point-based elasticity after Müller et al. (2004), total Lagrangian, with the discrete energy's own
// forces. Shape functions live in material space and change only where neighbourhoods do.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "graph/visibility_graph.h"
#include "mechanics/elasticity.h"
#include "mechanics/potential.h"
#include "sampling/node_set.h"

namespace geo {

/// How well a node's neighbours span space.
enum class Rung : std::uint8_t { full, regularised, rigid };

struct State {
  std::vector<Vec3> displacement;  ///< per node, model units
  std::vector<Vec3> velocity;      ///< per node, model units per second
};

/// What acts on nodes besides elasticity.
struct Environment {
  Vec3 gravity = {0, 0, -9.81};
  bool ground = false;
  Vec3 ground_point = Vec3::Zero(), ground_normal = Vec3::UnitZ();
  double ground_stiffness = 1e4;  ///< per node mass: acceleration per unit of depth, 1/s²
  double friction = 0.5;          ///< share of the tangential velocity that a touching node loses per 0.01 s
  std::vector<double> clearance;  ///< per node: distance to the skin below it; empty: none
  std::vector<std::uint8_t> fixed;  ///< per node: 1 keeps it where it is; empty: none
  Potential* contact = nullptr;     ///< of the implicit step; none: nothing touches
};

struct StepReport {
  int newton = 0, cg = 0, substeps = 0;
  double energy = 0;  ///< elastic, J, after the step
};

class Solid {
 public:
  /// Shape functions from scratch. Throws InputError for an impossible material.
  Solid(const NodeSet& nodes, const VisibilityGraph& graph, const Material& material);

  /// After a split: new nodes take part, rows of `updated` (ascending) are recomputed; equal to a build from scratch, bit
  /// for bit. `donors` of the nodes from `first_new` on: a new node moves with its donor's affine map and velocity, so
  /// linear momentum is what it was.
  void update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
              std::span<const NodeId> updated, State& state);

  std::size_t size() const { return mass_.size(); }
  double mass(NodeId i) const { return mass_[i.index()]; }
  Rung rung(NodeId i) const { return rung_[i.index()]; }
  const Material& material() const { return material_; }

  /// ∇u at every node, by moving least squares: exact for linear fields where the rung is full.
  std::vector<Mat3> gradients(const std::vector<Vec3>& u) const;
  /// ∇u at node i is Σ u_j g_jᵀ: appends j and g_j (1/m), the node itself included; the g_j sum to zero.
  void gradient_row(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const;
  /// Elastic energy, J, and forces −∂U/∂u, N; forces sum to zero.
  double energy(const std::vector<Vec3>& u) const;
  std::vector<Vec3> forces(const std::vector<Vec3>& u) const;

  /// Backward Euler as an incremental potential: Newton, conjugate gradients with 3×3 block Jacobi, line search.
  StepReport step_implicit(State& state, double dt, const Environment& environment) const;
  /// Leapfrog (symplectic Euler) with as many substeps as the fastest wave asks for.
  StepReport step_explicit(State& state, double dt, const Environment& environment) const;

  /// Total linear momentum.
  Vec3 momentum(const State& state) const;

 private:
  struct Row {
    std::vector<std::uint32_t> to;
    std::vector<Vec3> g, x;           // gradient vectors; material offsets to the neighbour
    std::vector<double> penalty;      // weights of the mode penalty, 1/m²
    Vec3 g_self = Vec3::Zero();
  };
  void build_row(std::uint32_t i, const NodeSet& nodes, const VisibilityGraph& graph);
  void transpose();
  double elastic_force(const std::vector<Vec3>& u, std::vector<Vec3>* force) const;
  void multiply(const std::vector<Mat9>& h, const std::vector<Vec3>& p, std::vector<Vec3>& out) const;
  void gather(const std::vector<Mat3>& node_stress, const std::vector<std::vector<Vec3>>& pull, std::vector<Vec3>& out) const;
  Mat3 gradient(std::uint32_t i, const std::vector<Vec3>& u) const;

  Material material_;
  std::vector<double> mass_, volume_, spacing_;
  std::vector<Rung> rung_;
  std::vector<Row> rows_;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> incoming_;  // per node: rows that hold it, and where
  std::vector<Vec3> material_position_;
};

}  // namespace geo
