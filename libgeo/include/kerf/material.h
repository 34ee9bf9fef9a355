// Hyperelastic energies: density, stress, and its derivative, made positive for Newton's method.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

enum class ElasticModel { saint_venant_kirchhoff, neo_hookean };

/// Where strain energy is summed. `galerkin`: at quadrature points, with the full derivative of the shape functions;
/// `mueller04`: at nodes, with moving least squares' own (diffuse) one, softer by a fifth or more (docs/validation.md).
enum class Discretisation { galerkin, mueller04 };

struct Material {
  Discretisation discretisation = Discretisation::galerkin;
  ElasticModel model = ElasticModel::neo_hookean;
  double young = 1e5;          ///< Pa (model units: m)
  double poisson = 0.3;        ///< −1 < ν < 0.5
  double density = 1000;       ///< kg/m³
  double volume_term = 0;      ///< k_v of ½ k_v (det F − 1)², Pa; keeps Saint-Venant–Kirchhoff from collapsing
  double damping = 0.5;        ///< mass-proportional, 1/s
  double viscosity = 0;        ///< η of ½ η |Ė|², E the Green strain, Pa·s: resists changes of shape, not motion
  double mode_penalty = 0.05;  ///< of mueller04: α of the penalty on modes that nodal strains do not see
  double yield = 0;            ///< norm of the elastic strain beyond which material flows; 0: never (plasticity.h)
  double creep = 1;            ///< the share of the elastic strain that flows in a second
  double most_plastic = 1;     ///< norm that the plastic strain cannot pass
  double lambda() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }
  double mu() const { return young / (2 * (1 + poisson)); }
  friend bool operator==(const Material&, const Material&) = default;
};

/// Throws InputError unless E > 0, −1 < ν < 0.5, ρ > 0 and the rest is not negative.
void require_material(const Material& material);

/// Energy density at deformation gradient F, J/m³; zero at rotations.
double energy_density(const Material& material, const Mat3& f);
/// First Piola–Kirchhoff stress ∂Ψ/∂F, Pa.
Mat3 stress(const Material& material, const Mat3& f);
/// What stiffness needs of a material (stiffness_lanes.h): μ, λ and α of the stable neo-Hookean energy are its own.
struct StiffnessConstants {
  bool neo_hookean = true;
  float mu = 0, lambda = 0, alpha = 1, volume = 0;
  float viscous = 0;  ///< η/Δt on the symmetric part of the gradient: what viscosity has at small strain
};
StiffnessConstants stiffness_constants(const Material& material);
using Mat9 = Eigen::Matrix<double, 9, 9>;
/// ∂²Ψ/∂F², column-major vectorised.
Mat9 stress_derivative(const Material& material, const Mat3& f);
/// The same with negative eigenvalues set to zero.
Mat9 projected_derivative(const Material& material, const Mat3& f);

// ---- What a solid is made of: one material, or several, of which each node has one. What no path in the material
// joins may differ.

class Materials {
 public:
  /// One for all. Throws InputError for an impossible one.
  Materials(const Material& all = {}) : Materials(std::vector<Material>{all}, {}) {}
  /// `of_node`: numbers in the table. Nodes that share a graph's component have the same. Throws InputError for an
  /// impossible material, for numbers that are not in the table, and where discretisations differ.
  Materials(std::vector<Material> table, std::vector<std::uint16_t> of_node);

  std::size_t count() const { return table_.size(); }
  const Material& operator[](std::size_t number) const { return table_[number]; }
  std::span<const Material> all() const { return table_; }
  std::uint16_t number(std::size_t node) const { return count() > 1 ? of_node_[node] : std::uint16_t(0); }
  const Material& of(std::size_t node) const { return table_[number(node)]; }
  Discretisation discretisation() const { return table_[0].discretisation; }
  void set(Discretisation discretisation);

  /// A new node, the next one, has the material of another.
  void add(std::size_t like);
  /// True where there are fewer nodes, or more.
  bool unfit(std::size_t nodes) const { return count() > 1 && of_node_.size() != nodes; }
  /// Whether any of them has what `has` asks for.
  template <class Has>
  bool any(const Has& has) const {
    return std::any_of(table_.begin(), table_.end(), has);
  }

 private:
  std::vector<Material> table_;
  std::vector<std::uint16_t> of_node_;  // empty where there is one material
};

/// Of a small-strain stiffness, Pa.
struct Moduli {
  float shear = 0, bulk = 0;
  friend bool operator==(const Moduli&, const Moduli&) = default;
};

}  // namespace geo
