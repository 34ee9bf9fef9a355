// A deforming solid, total Lagrangian, discretised by nodes with moving-least-squares shape
// functions. Shape functions live in material space; a cut changes them only where it passes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/body.h"
#include "kerf/graph.h"
#include "kerf/indirect.h"
#include "kerf/material.h"
#include "kerf/nodes.h"
#include "kerf/potential.h"
#include "kerf/vec.h"

namespace geo {

struct SolidDiscretisation;  // private: nodes, material points, subdomains
struct SolverCache;          // private: inverses of the last step

// ---- The motion, and what acts on it from outside

/// The motion of a solid at one instant.
struct State {
  std::vector<Vec3> displacement;       ///< per node, model units
  std::vector<Vec3> velocity;           ///< per node, model units per second
  std::vector<Vec3> acceleration = {};  ///< per node, of the last time step, for the inertial predictor; empty: unknown
  std::vector<Mat3> plastic = {};       ///< per material point: plastic part of the Green strain; empty: none yet
  std::vector<Mat3> rotation = {};      ///< per node: rotation of debris, whose neighbours do not determine it; the
                                        ///< identity for other nodes; empty: no debris yet
  /// Per material point: the symmetric, positive stretch of the material at rest, from its state
  /// without stress (V of F = V R). Empty: none.
  std::vector<Mat3> prestretch = {};
  /// Per node: 1 where `acceleration` is of a step that no contact or cut has interrupted, so that
  /// ImplicitScheme::bossak goes on from it. Empty: nowhere.
  std::vector<std::uint8_t> smooth = {};
};

/// External actions on the nodes: gravity, loads, clamps, contact.
struct Environment {
  Vec3 gravity = {0, 0, -9.81};     ///< acceleration, m/s²
  std::vector<std::uint8_t> fixed;  ///< per node: 1 clamps it; empty: no node is clamped
  /// Per node: 1 where it sleeps. It is clamped, too, and so do all nodes of its component of the
  /// graph, none of which an implicit step computes. Empty: no node sleeps.
  std::vector<std::uint8_t> asleep = {};
  std::vector<Vec3> load;           ///< per node: a force, N; empty: none
  std::vector<Potential*> contact;  ///< further energies, such as contact, springs, wind; not owned
};

// ---- The solid

/// Work and result of one time step.
struct StepReport {
  int newton = 0;     ///< Newton iterations
  int cg = 0;         ///< iterations of conjugate gradients, over all Newton iterations
  int substeps = 0;   ///< time steps that the step was divided into
  double energy = 0;  ///< elastic energy after the step, J; of the implicit step to second order in the last direction
  /// False: Newton's method has not found the step, and the state is as before. Only where the
  /// step was not to be divided.
  bool converged = true;
};

/// Numbers of nodes and of material points by the quality of their moment matrix: 0
/// well-conditioned, 1 ill-conditioned (at nodes: of lower rank), 2 singular, so that they carry no
/// strain.
struct MomentQualityCounts {
  std::size_t nodes[3] = {};   ///< by quality
  std::size_t points[3] = {};  ///< by quality
  std::size_t widened = 0;     ///< points whose support had to be widened
};

/// Whether an implicit step may be divided where Newton's method does not find it.
enum class Division { allowed, refused };

/// How an implicit step integrates inertia.
enum class ImplicitScheme : std::uint8_t {
  backward_euler,  ///< of first order: it damps all that turns or swings
  /// That of Wood, Bossak and Zienkiewicz (1980), of second order, where the motion is smooth; else
  /// backward Euler (docs/decisions/120).
  bossak
};

/// The discretised solid and its time integrators. Copies are deep.
class Solid {
 public:
  /// Discretises a body from scratch by the materials' discretisation. Throws InputError where
  /// `materials` lists another number of nodes than the body has.
  Solid(const Body& body, Materials materials);
  /// Discretises nodes and graph alone, always by mueller04: no surface is known that cells could
  /// be clipped to.
  Solid(const NodeSet& nodes, const VisibilityGraph& graph, Materials materials);

  /// Updates the discretisation and `state` after a split; the result equals a build from scratch,
  /// bit for bit. New nodes take the motion of old nodes around them and their donors' material.
  /// Each component of the graph then gets the rigid motion that restores its linear momentum and
  /// its angular momentum about its centre of mass. Plastic strain and prestretch stay with their
  /// point; new points have the mean of those about them.
  void update(const Body& body, const BodyDelta& delta, State& state);
  /// First half of update(), after each split: nodes, their motion and their gradients.
  void update_nodes(const Body& body, const BodyDelta& delta, State& state);
  /// Second half of update(), once after several splits and before energy, forces, stress or a step
  /// is computed: material points and the preconditioner's subdomains.
  void update_points(const Body& body, State& state);
  /// The same as update() of a solid that was made of nodes and graph alone. `donors`: per new
  /// node, from `first_new` on; `updated`: nodes whose neighbourhood changed.
  void update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
              std::span<const NodeId> updated, State& state);

  /// Imposes the motion of the nodes in boxes on the material there, for steps that fix these nodes
  /// (Environment::fixed). Replaces the boxes of the last call; a node in several belongs to the
  /// first. A box without four nodes that span a tetrahedron, and any box with mueller04, holds its
  /// nodes only. Call it after update_points(). Throws InputError where a box has lo > hi.
  void hold(const Body& body, std::span<const HeldBox> boxes);

  /// Replaces the materials by others of the same table size, assignment to nodes, densities and
  /// discretisation. Throws InputError for any other table.
  void set_materials(const Materials& materials);

  /// Number of nodes.
  std::size_t size() const;
  /// Lumped mass of node i, kg.
  double mass(NodeId i) const;
  /// The material of each node.
  const Materials& materials() const;
  /// Number of material points.
  std::size_t point_count() const;
  /// The material coordinates of the material points, in their order.
  std::vector<Vec3> point_positions() const;
  /// Counts nodes and material points by the quality of their moment matrix.
  MomentQualityCounts moment_quality_counts() const;

  /// ∇u of displacements at every node by moving least squares, exact for linear fields where the
  /// moment matrix has full rank. Elsewhere it is completed by the rotation of debris
  /// (set_rotations()).
  std::vector<Mat3> gradients(const std::vector<Vec3>& u) const;
  /// Appends j and g_j (1/m) for every node j with ∇u_i = Σ u_j g_jᵀ, node i itself included; the
  /// g_j sum to zero. Without the rotation of debris.
  void gradient_stencil(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const;
  /// Elastic energy at displacements u, J, without plastic strain and prestretch.
  double energy(const std::vector<Vec3>& u) const;
  /// Elastic energy of a state, J.
  double energy(const State& state) const;
  /// Elastic forces −∂U/∂u at displacements u, N per node; they sum to zero.
  std::vector<Vec3> forces(const std::vector<Vec3>& u) const;
  /// The same of a state.
  std::vector<Vec3> forces(const State& state) const;
  /// ∂²U/∂u² p with the implicit step's stiffness at u: in single precision, negative eigenvalues
  /// left out. N per node.
  std::vector<Vec3> stiffness_product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) const;
  /// The Cauchy stress about a place: the mean over material points near it, weighted by volume and
  /// the kernel.
  /// \param x  material coordinates
  /// \param radius  of the material points that count, model units
  /// \param sees  where given, accepts the positions of the points that count
  /// \return Pa; zero where no point counts
  Mat3 stress_at(const State& state, const Vec3& x, double radius,
                 const std::function<bool(const Vec3&)>& sees = {}) const;

  /// Advances a state with backward Euler or Bossak's scheme: Newton's method on the incremental
  /// potential, conjugate gradients with a two-level preconditioner, line search. A step that does
  /// not converge is halved, recursively. Not const: the preconditioner's inverses are kept for the
  /// next step, which changes its time and not its result.
  /// \param dt  s
  /// \param accuracy  of displacements, relative to the spacing of nodes
  /// \param division  whether it is, or given up: StepReport::converged
  /// \param scheme  of inertia
  StepReport step_implicit(State& state, double dt, const Environment& environment, double accuracy = 1e-3,
                           Division division = Division::allowed,
                           ImplicitScheme scheme = ImplicitScheme::backward_euler);
  /// Advances a state with symplectic Euler, in as many substeps as the fastest wave requires;
  /// twice as many where energy would rise.
  /// \param dt  s
  StepReport step_explicit(State& state, double dt, const Environment& environment);
  /// Takes over State::rotation of a state that this solid has not computed, as one read from a
  /// file. Steps and updates do it themselves.
  void set_rotations(const State& state);

  /// Total linear momentum, kg m/s.
  Vec3 momentum(const State& state) const;
  /// Angular momentum about the world's origin, kg m²/s.
  Vec3 angular_momentum(const State& state) const;
  /// Kinetic energy, J.
  double kinetic_energy(const State& state) const;

 private:
  friend struct SolidDiscretisation;  // it alone reaches itself, for the library's own code
  Indirect<SolidDiscretisation> discretisation_;
  Indirect<SolverCache> cache_;
};

// ---- Nodal fields for pictures.

/// Displacement of the material at each node: Eq. 1 over the node and its neighbours. A node's own
/// displacement is a coefficient of that field; beside cracks, where nodes are crowded, the two
/// differ.
std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph,
                                        const State& state);

/// Von Mises equivalent of the Cauchy stress at each node, Pa: the mean over the material points
/// that see the node and have it in their shape functions, weighted by volume and the kernel over
/// the node's support. Plastic strain is subtracted, viscous stress left out. Zero where no point
/// contributes.
std::vector<double> von_mises_stress(const Solid& solid, const NodeSet& nodes, const State& state);

}  // namespace geo
