// Relative displacement of two points of the surface as a stencil over the nodes.
#pragma once

#include <array>
#include <vector>

#include "contact/surface/coincident_vertices.h"
#include "contact/surface/surface_weights.h"

namespace geo {

/// A point of the surface: up to three surface vertices with weights that sum to 1.
struct SurfacePoint {
  std::uint32_t vertex[3];
  double weight[3];
  int size;
};

/// Position of a point when the surface vertices are at `positions`.
inline Vec3 position_of(const SurfacePoint& p, const std::vector<Vec3>& positions) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < p.size; ++k) sum += p.weight[k] * positions[p.vertex[k]];
  return sum;
}

/// The displacement of point a less that of point b is Σ weight × nodal displacement. An impulse
/// along it that changes the nodes' velocities by weight × inverse mass conserves momentum.
struct RelativeStencil {
  std::vector<NodeWeight> entries;  ///< no node twice, in no particular order
  double inverse_mass = 0;          ///< effective, 1/kg: Σ weight² × inverse mass of the node
  double inverse_mass_a = 0;        ///< the same of point a alone, as if b were fixed
  double inverse_mass_b = 0;        ///< the same of point b alone
};

/// Makes stencils one at a time, with scratch memory per node that is cleared after each.
class RelativeStencilBuilder {
 public:
  /// `stands_for`: the surface vertices whose mean a vertex of a point is. `inverse_mass`: per
  /// node, 1/kg; 0 for fixed nodes. Refers to all of them.
  RelativeStencilBuilder(const SurfaceWeights& weights, const CoincidentVertices& stands_for,
                         const std::vector<double>& inverse_mass);
  /// The stencil of a's displacement less b's.
  RelativeStencil make(const SurfacePoint& a, const SurfacePoint& b);

 private:
  using PointWeights = std::array<double, 2>;  // of a node in a and in b
  void add(const SurfacePoint& point, std::size_t which);

  const SurfaceWeights& weights_;
  const CoincidentVertices& stands_for_;
  const std::vector<double>& inverse_mass_;
  std::vector<PointWeights> sum_;     // per node; zero between calls
  std::vector<std::uint8_t> in_use_;  // per node; zero between calls
  std::vector<std::uint32_t> nodes_;  // of the current stencil, in the order found
};

}  // namespace geo
