// The discretisation of a solid, as contact, simulation and the time integrators read it. Solid
// owns it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "kerf/material.h"
#include "kerf/solid.h"
#include "mechanics/discretisation/as_rigid_energy.h"
#include "mechanics/discretisation/galerkin.h"
#include "mechanics/discretisation/held_material.h"
#include "mechanics/discretisation/nodal_gradients.h"
#include "mechanics/discretisation/point_lanes.h"
#include "mechanics/solver/aggregates.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/subdomain_inverses.h"
#include "mechanics/solver/subdomains.h"

namespace geo {

/// Nodes, material points and the geometry of both levels of the preconditioner. Everything lives
/// in material space: a time step reads it, a split updates it.
struct SolidDiscretisation {
  /// Allocates nothing; update_nodes() fills it.
  explicit SolidDiscretisation(Materials of_nodes) : materials(std::move(of_nodes)) {}
  /// The discretisation of a solid.
  static const SolidDiscretisation& of(const Solid& solid) { return *solid.discretisation_; }

  Materials materials;                   ///< of each node
  std::vector<double> mass;              ///< per node, kg
  std::vector<double> volume;            ///< per node, m³
  std::vector<double> spacing;           ///< per node: distance to its neighbours, m
  std::vector<Vec3> position;            ///< per node, material coordinates, m
  std::vector<std::uint32_t> component;  ///< per node: its component of the visibility graph
  std::uint32_t components = 0;          ///< number of components of the graph
  NodalGradientOperator mls;             ///< moving least squares at nodes: gradients of nodal fields
  Aggregates aggregates;                 ///< of the coarse space
  Subdomains subdomains;                 ///< of the Schwarz preconditioner
  MaterialPoints points;                 ///< quadrature points, or one point a node (mueller04)
  std::optional<Galerkin> galerkin;      ///< quadrature cells; none with mueller04
  HeldMaterial held;                     ///< points near boxes that are held; only with quadrature cells
  AsRigidEnergy as_rigid;                ///< of nodes that too few points strain
  std::optional<ModePenalty> penalty;    ///< on modes that nodal strains do not see; only with mueller04
  std::vector<char> changed;  ///< per node: 1 if its position, spacing or gradient changed since update_points()

  /// Number of nodes.
  std::size_t size() const { return mass.size(); }
  /// Stride of the points over which the coarse space is summed, weighted by the stride. Quadrature
  /// has four points per cell: a stride of 5 takes another point from cell to cell and skips every
  /// fifth cell. Results agree to the accuracy of the step, at a fifth of the work (measured in
  /// docs/decisions/044).
  std::size_t coarse_point_stride() const { return galerkin ? 5 : 1; }
  /// Whether any material yields.
  bool is_plastic() const {
    return materials.any([](const Material& m) { return m.yield > 0; });
  }

  /// Updates nodes, gradients and components after a change of nodes or graph, and transfers motion
  /// to new and moved nodes (Solid::update). `parted`: whether components may have come apart.
  void update_nodes(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new,
                    std::span<const NodeId> donors, std::span<const NodeId> updated, State& state, bool parted = true);
  /// Makes every node a material point (mueller04), of the same blocks where nothing changed.
  void update_nodal_points(std::span<const NodeId> updated);
  /// Sets the penalty on modes by the materials; does nothing where there is none.
  void update_mode_penalty();
  /// Updates quadrature points, subdomains and aggregates after splits. `inverses` of unchanged
  /// subdomains stay valid; the plastic strain of `state` stays with its points. Precondition:
  /// galerkin->has_changes().
  void update_quadrature_points(const Body& body, State& state, SubdomainInverses& inverses);
  /// Imposes the motion of boxes on their material. The preconditioner keeps the plain basis.
  void hold(const Body& body, std::span<const HeldBox> boxes);
  /// Gives an energy of their own to nodes with less than one point's share of the points.
  /// Precondition: points have the plain basis.
  void update_as_rigid();
  /// Builds subdomains and aggregates from scratch.
  void build_preconditioner_levels();

  /// Elastic energy at displacements u, J; `force`, where given, becomes −∂U/∂u, N per node.
  /// `relaxation`: as relaxation_of() returns it.
  double elastic_energy(const std::vector<Vec3>& u, std::vector<Vec3>* force,
                        const std::vector<PointRelaxation>& relaxation = {}) const;
  /// Per block: what elasticity does not see of F, from plastic strain and prestretch; empty where
  /// there is none. Throws InputError if `state` has those of another number of points.
  std::vector<PointRelaxation> relaxation_of(const State& state) const;
  /// Lets plastic strain flow for dt seconds at the displacements of `state`.
  void update_plasticity(State& state, double dt) const;

 private:
  void apply_held(const Body& body, PointChanges* changes);
  void number_new_components(const VisibilityGraph& graph, std::size_t first_new);
};

/// Gradients ∇u at nodes, each computed on first use.
inline LazyNodalGradients lazy_gradients(const SolidDiscretisation& solid, const std::vector<Vec3>& u) {
  return {solid.mls, u};
}

}  // namespace geo
