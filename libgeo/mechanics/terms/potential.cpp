// Potential::eigenvalue_bound() of kerf/potential.h. Gershgorin's bound: no eigenvalue of
// M⁻¹ Σ_k s_k w_k w_kᵀ exceeds its largest absolute row sum,
// max_i m_i⁻¹ Σ_k s_k |w_ki| Σ_j |w_kj|.
#include "kerf/potential.h"

#include <algorithm>
#include <cmath>

namespace geo {

double Potential::eigenvalue_bound(const std::vector<double>& inverse_mass) const {
  std::vector<double> row_sum(inverse_mass.size(), 0);
  for (std::size_t k = 0; k < size(); ++k) {
    const double stiffness = stiffness_bound(k);
    if (!(stiffness > 0)) continue;
    const double norm = weight_norm(stencil(k));
    for (const auto& e : stencil(k)) row_sum[e.node] += stiffness * std::abs(e.weight) * norm;
  }
  double largest = 0;
  for (std::size_t i = 0; i < row_sum.size(); ++i) largest = std::max(largest, row_sum[i] * inverse_mass[i]);
  return largest;
}

}  // namespace geo
