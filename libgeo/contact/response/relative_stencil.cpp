// Weight of node j: w_j = Σ weights of a − Σ weights of b; effective inverse mass Σ w_j² / m_j.
#include "contact/response/relative_stencil.h"

namespace geo {

RelativeStencilBuilder::RelativeStencilBuilder(const SurfaceWeights& weights, const CoincidentVertices& stands_for,
                                               const std::vector<double>& inverse_mass)
    : weights_(weights),
      stands_for_(stands_for),
      inverse_mass_(inverse_mass),
      sum_(inverse_mass.size(), PointWeights{0, 0}),
      in_use_(inverse_mass.size(), 0) {}

RelativeStencil RelativeStencilBuilder::make(const SurfacePoint& a, const SurfacePoint& b) {
  RelativeStencil stencil;
  nodes_.clear();
  add(a, 0);
  add(b, 1);
  stencil.entries.reserve(nodes_.size());
  for (const auto j : nodes_) {
    const auto [weight_a, weight_b] = sum_[j];
    const double weight = weight_a - weight_b;
    if (weight != 0) stencil.entries.push_back({j, weight});
    stencil.inverse_mass += weight * weight * inverse_mass_[j];
    stencil.inverse_mass_a += weight_a * weight_a * inverse_mass_[j];
    stencil.inverse_mass_b += weight_b * weight_b * inverse_mass_[j];
    sum_[j] = {0, 0};
    in_use_[j] = 0;
  }
  return stencil;
}

void RelativeStencilBuilder::add(const SurfacePoint& point, std::size_t which) {
  for (int k = 0; k < point.size; ++k) {
    const auto coincident = stands_for_[point.vertex[k]];
    for (const auto v : coincident)
      for (const auto& e : weights_.stencil(v)) {
        if (!in_use_[e.node]) {
          nodes_.push_back(e.node);
          in_use_[e.node] = 1;
        }
        sum_[e.node][which] += point.weight[k] / double(coincident.size()) * e.weight;
      }
  }
}

}  // namespace geo
