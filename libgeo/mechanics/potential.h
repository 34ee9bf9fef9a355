// An energy of node displacements that acts besides elasticity: what contact brings into a time step.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/vec.h"

namespace geo {

/// A node, and by how much it counts.
struct NodeWeight {
  std::uint32_t node;
  double weight;
};
/// Σ weight × value: what the nodes' values come to.
inline Vec3 weighed(std::span<const NodeWeight> entries, const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (const auto& e : entries) sum += e.weight * values[e.node];
  return sum;
}

/// A sum of energies, each of a weighed sum of displacements: its rows. One value per node in all vectors.
class Potential {
 public:
  /// A row's nodes, none twice, and its curvature, N/m: of the energy over their weighed displacement. Never negative.
  using VisitRow = std::function<void(std::span<const NodeWeight>, const Mat3& curvature)>;

  virtual ~Potential() = default;
  /// A part of the time step begins at displacements u: from and to in shares of the whole step, 0 to 1. A part that failed is
  /// begun again, shorter; one from 0 begins the step anew.
  virtual void begin(const std::vector<Vec3>&, double /*from*/, double /*to*/) {}
  /// All rows, the same ones in the same order until the next begin(), where they are until then, with their curvatures at the
  /// displacements of the last force() call; zero for a row that does nothing.
  virtual void each_row(const VisitRow& visit) const = 0;
  /// Adds to sum[part[i]] the energy, J, at displacements u of what it does to node i; nodes of a row are of one part.
  virtual void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sum) const = 0;
  /// Of all nodes.
  double energy(const std::vector<Vec3>& u) const {
    std::vector<double> sum(1, 0);
    add_energy(u, std::vector<std::uint32_t>(u.size(), 0), sum);
    return sum[0];
  }
  /// Adds −∂E/∂u, N.
  virtual void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) = 0;

  /// A row's nodes, and the most that its curvature may come to, N/m.
  using VisitStiffness = std::function<void(std::span<const NodeWeight>, double stiffness)>;
  /// Rows that act in the explicit step.
  virtual void each_stiffness(const VisitStiffness&) const {}
  /// Of these, where nodes that are held have no inverse mass: the largest sum of absolute values in a row of M⁻¹ Σ k w wᵀ, no less
  /// than the largest eigenvalue of M⁻¹ ∂²E/∂u², 1/s²; 0: there are none.
  double stiffest(const std::vector<double>& inverse_mass) const;
  /// Changes velocities by what it does in h seconds from displacements u on.
  virtual void impulse(const std::vector<Vec3>&, double /*h*/, const std::vector<double>& /*inverse_mass*/, std::vector<Vec3>& /*velocity*/) {}
};

}  // namespace geo
