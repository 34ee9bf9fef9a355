#include "mechanics/terms/potential.h"

#include <algorithm>
#include <cmath>

namespace geo {

double Potential::stiffest(const std::vector<double>& inverse_mass) const {
  std::vector<double> sum(inverse_mass.size(), 0);
  for (std::size_t r = 0; r < size(); ++r) {
    const double firm = stiffness(r);
    if (!(firm > 0)) continue;
    const double all = spread(row(r));
    for (const auto& e : row(r)) sum[e.node] += firm * std::abs(e.weight) * all;
  }
  double most = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) most = std::max(most, sum[i] * inverse_mass[i]);
  return most;
}

}  // namespace geo
