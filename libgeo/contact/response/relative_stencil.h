// How two places of the surface move against each other, as one row over the nodes.
#pragma once

#include <array>
#include <vector>

#include "contact/surface/copies.h"
#include "contact/surface/surface_weights.h"

namespace geo {

/// A place of the surface: up to three surface vertices with weights that sum to 1.
struct SurfacePoint {
  std::uint32_t vertex[3];
  double weight[3];
  int size;
};

struct RelativeStencil {
  std::vector<SurfaceWeights::Entry> entries;  ///< of a's motion less b's, nodes in no particular order
  double mobility = 0;                         ///< Σ weight² × inverse mass
  double of_a = 0, of_b = 0;                   ///< the same of each alone: what the pair's would be were the other held
};

/// Where it is when vertices are at `at`.
inline Vec3 place(const SurfacePoint& p, const std::vector<Vec3>& at) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < p.size; ++k) sum += p.weight[k] * at[p.vertex[k]];
  return sum;
}

/// Makes rows, one at a time. `stands_for`: which surface vertices carry one vertex of a place (they move as their
/// average).
class RelativeStencilBuilder {
 public:
  RelativeStencilBuilder(const SurfaceWeights& weights, const Copies& stands_for,
                         const std::vector<double>& inverse_mass);
  RelativeStencil make(const SurfacePoint& a, const SurfacePoint& b);

 private:
  using Sums = std::array<double, 2>;  // of a and b
  void add(const SurfacePoint& place, std::size_t which);

  const SurfaceWeights& weights_;
  const Copies& stands_for_;
  const std::vector<double>& inverse_mass_;
  std::vector<Sums> sum_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> used_;
};

}  // namespace geo
