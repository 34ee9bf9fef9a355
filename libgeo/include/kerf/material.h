// Materials of a deforming solid: parameters, hyperelastic energy density and stress; boxes that
// hold material.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// The hyperelastic energy: Saint-Venant–Kirchhoff, or the stable neo-Hookean one of Smith, de Goes
/// and Kim (2018).
enum class ElasticModel { saint_venant_kirchhoff, neo_hookean };

/// Where strain energy is integrated. `galerkin`: at quadrature points, with the full derivative of
/// the shape functions (Belytschko, Lu and Gu 1994). `mueller04`: at nodes, with the diffuse
/// derivative of moving least squares (Müller et al. 2004); softer by a fifth or more
/// (docs/validation.md).
enum class Discretisation { galerkin, mueller04 };

/// Parameters of one material. Model units are metres.
struct Material {
  Discretisation discretisation = Discretisation::galerkin;
  ElasticModel model = ElasticModel::neo_hookean;
  double young = 1e5;          ///< Young's modulus E, Pa
  double poisson = 0.3;        ///< Poisson's ratio, −1 < ν < 0.5
  double density = 1000;       ///< ρ, kg/m³
  double volume_term = 0;      ///< k_v of ½ k_v (det F − 1)², Pa; keeps Saint-Venant–Kirchhoff from collapsing
  double damping = 0;          ///< mass-proportional damping, 1/s: a drag, on rigid motion, too
  double viscosity = 0;        ///< η of ½ η |Ė|², E the Green strain, Pa·s: resists deformation, not rigid motion
  double mode_penalty = 0.05;  ///< mueller04 only: α of the penalty on zero-energy modes of nodal strains
  double yield = 0;            ///< norm of the elastic strain above which material flows; 0: never
  double creep = 1;            ///< fraction of the elastic strain that flows per second
  double max_plastic = 1;      ///< upper bound of the plastic strain's norm

  double lambda() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }  ///< Lamé's λ, Pa
  double mu() const { return young / (2 * (1 + poisson)); }                                ///< shear modulus μ, Pa
  /// True if all parameters are equal.
  friend bool operator==(const Material&, const Material&) = default;
};

/// Throws InputError unless E > 0, −1 < ν < 0.5, ρ > 0 and all other parameters are non-negative.
void require_material(const Material& material);

/// Energy density Ψ at deformation gradient F, J/m³; zero at rotations.
double energy_density(const Material& material, const Mat3& f);

/// First Piola–Kirchhoff stress ∂Ψ/∂F, Pa.
Mat3 stress(const Material& material, const Mat3& f);

/// The materials of a solid: one for all nodes, or a table and an index per node. Nodes of one
/// component of the visibility graph must share a material.
class Materials {
 public:
  /// One material for all nodes. Throws InputError if it is invalid (require_material).
  Materials(const Material& all = {}) : Materials(std::vector<Material>{all}, {}) {}
  /// A table, and per node an index into it. Throws InputError if a material is invalid, an index
  /// is out of range or discretisations differ.
  Materials(std::vector<Material> table, std::vector<std::uint16_t> index_of_node);

  /// The number of materials in the table.
  std::size_t count() const { return table_.size(); }
  /// The material at an index of the table.
  const Material& operator[](std::size_t index) const { return table_[index]; }
  /// The table.
  std::span<const Material> all() const { return table_; }
  /// The index of a node's material.
  std::uint16_t index(std::size_t node) const { return count() > 1 ? index_of_node_[node] : std::uint16_t(0); }
  /// The material of a node.
  const Material& of(std::size_t node) const { return table_[index(node)]; }
  /// The discretisation that all materials share.
  Discretisation discretisation() const { return table_[0].discretisation; }
  /// Sets the discretisation of all materials.
  void set_discretisation(Discretisation discretisation);

  /// Appends a node with the material of node `donor`.
  void add_node(std::size_t donor);
  /// True if every one of `nodes` nodes has a material, and no others do.
  bool fits(std::size_t nodes) const { return count() == 1 || index_of_node_.size() == nodes; }
  /// True if `predicate` holds for any material.
  template <class Predicate>
  bool any(const Predicate& predicate) const {
    return std::any_of(table_.begin(), table_.end(), predicate);
  }

 private:
  std::vector<Material> table_;
  std::vector<std::uint16_t> index_of_node_;  // empty if there is one material
};

/// Material that follows a rigid motion: that of the fixed nodes in the box.
struct HeldBox {
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();  ///< corners, material coordinates
  bool rigid = true;  ///< false: its nodes do not move as a rigid body, so the material between them is left alone
  /// Equality of all members.
  friend bool operator==(const HeldBox&, const HeldBox&) = default;
};

}  // namespace geo
