#include "contact/response/relative_stencil.h"

namespace geo {

RelativeStencilBuilder::RelativeStencilBuilder(const SurfaceWeights& weights, const Copies& stands_for,
                                               const std::vector<double>& inverse_mass)
    : weights_(weights),
      stands_for_(stands_for),
      inverse_mass_(inverse_mass),
      sum_(inverse_mass.size(), Sums{0, 0}),
      taken_(inverse_mass.size(), 0) {}

RelativeStencil RelativeStencilBuilder::make(const SurfacePoint& a, const SurfacePoint& b) {
  RelativeStencil row;
  used_.clear();
  add(a, 0), add(b, 1);
  row.entries.reserve(used_.size());
  for (const auto j : used_) {
    const auto [of_a, of_b] = sum_[j];
    const double weight = of_a - of_b;
    if (weight != 0) row.entries.push_back({j, weight});
    row.mobility += weight * weight * inverse_mass_[j];
    row.of_a += of_a * of_a * inverse_mass_[j], row.of_b += of_b * of_b * inverse_mass_[j];
    sum_[j] = {0, 0}, taken_[j] = 0;
  }
  return row;
}

void RelativeStencilBuilder::add(const SurfacePoint& place, std::size_t which) {
  for (int k = 0; k < place.size; ++k) {
    const auto copies = stands_for_[place.vertex[k]];
    for (const auto v : copies)
      for (const auto& e : weights_.row(v)) {
        if (!taken_[e.node]) used_.push_back(e.node), taken_[e.node] = 1;
        sum_[e.node][which] += place.weight[k] / double(copies.size()) * e.weight;
      }
  }
}

}  // namespace geo
