// Potentials assembled at the nodes: the sum over stencils written out, and PotentialSum with all
// nodes in one island.
#pragma once

#include <vector>

#include "mechanics/terms/potential_sum.h"

namespace geo {

/// The energy at displacements u, J, term by term.
inline double energy_of(const Potential& potential, const std::vector<Vec3>& u) {
  double sum = 0;
  for (std::size_t k = 0; k < potential.size(); ++k) sum += potential.energy(k, weighted_sum(potential.stencil(k), u));
  return sum;
}

/// Nodal forces at displacements u, N, term by term.
inline std::vector<Vec3> force_of(Potential& potential, const std::vector<Vec3>& u) {
  std::vector<Vec3> force(u.size(), Vec3::Zero());
  for (std::size_t k = 0; k < potential.size(); ++k)
    for (const auto& e : potential.stencil(k))
      force[e.node] += e.weight * potential.derivatives(k, weighted_sum(potential.stencil(k), u)).force;
  return force;
}

/// u + step · direction.
inline std::vector<Vec3> moved(std::vector<Vec3> u, double step, const std::vector<Vec3>& direction) {
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += step * direction[i];
  return u;
}

/// Σ a_i · b_i over nodes.
inline double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

/// A PotentialSum whose nodes all belong to one island.
class AssembledPotential {
 public:
  /// After the potentials' begin_substep() at displacements u, which must outlive this.
  AssembledPotential(std::span<Potential* const> potentials, const std::vector<Vec3>& u)
      : sum_(potentials, u), island_(u.size(), 0) {}
  AssembledPotential(Potential& potential, const std::vector<Vec3>& u)
      : AssembledPotential(std::vector<Potential*>{&potential}, u) {}
  PotentialSum& sum() { return sum_; }

  double energy(const std::vector<Vec3>& u) {
    std::vector<double> energy(1, 0);
    sum_.add_energy(u, island_, {1}, energy);
    return energy[0];
  }
  /// Forces at u; product() uses the Hessian there from now on.
  std::vector<Vec3> force(const std::vector<Vec3>& u) {
    energy(u);
    sum_.update_derivatives(island_, {1});
    std::vector<Vec3> force;
    for (std::size_t i = 0; i < u.size(); ++i) force.push_back(sum_.force_at(i));
    return force;
  }
  std::vector<Vec3> product(const std::vector<Vec3>& p) {
    sum_.multiply_hessian(p);
    std::vector<Vec3> product;
    for (std::size_t i = 0; i < p.size(); ++i) product.push_back(sum_.hessian_product_at(i));
    return product;
  }

 private:
  PotentialSum sum_;
  std::vector<std::uint32_t> island_;
};

}  // namespace geo
