#include "mechanics/potential.h"

#include <algorithm>
#include <cmath>

namespace geo {

double Potential::stiffest(const std::vector<double>& inverse_mass) const {
  std::vector<double> sum(inverse_mass.size(), 0);
  for (std::size_t r = 0; r < size(); ++r) {
    const double firm = stiffness(r);
    if (!(firm > 0)) continue;
    double all = 0;
    for (const auto& e : row(r)) all += std::abs(e.weight);
    for (const auto& e : row(r)) sum[e.node] += firm * std::abs(e.weight) * all;
  }
  double most = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) most = std::max(most, sum[i] * inverse_mass[i]);
  return most;
}

}  // namespace geo
