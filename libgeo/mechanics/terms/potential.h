// An energy of node displacements that acts besides elasticity: what contact brings into a time step.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A node, and by how much it counts.
struct NodeWeight {
  std::uint32_t node;
  double weight;
};
/// Σ |weight|: how far the sum below goes at most where each value goes as far as 1.
inline double spread(std::span<const NodeWeight> entries) {
  double sum = 0;
  for (const auto& e : entries) sum += std::abs(e.weight);
  return sum;
}
/// Σ weight × value: what the nodes' values come to.
inline Vec3 weighed(std::span<const NodeWeight> entries, const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (const auto& e : entries) sum += e.weight * values[e.node];
  return sum;
}

/// A sum of energies, each of a row: of one weighed sum of displacements, its way, model units. One value per node in
/// all vectors.
class Potential {
 public:
  virtual ~Potential() = default;
  /// A part of the time step begins at displacements u: from and to in shares of the whole step, 0 to 1. A part that
  /// failed is begun again, shorter; one from 0 begins the step anew.
  virtual void begin(const std::vector<Vec3>&, double /*from*/, double /*to*/) {}
  /// Rows, as many and where they are until the next begin().
  virtual std::size_t size() const = 0;
  /// A row's nodes, none twice; of none: it does nothing. All can be made to depend on each other by it.
  virtual std::span<const NodeWeight> row(std::size_t r) const = 0;
  /// True where the nodes of each row hang together by the body's own graph, so that no row joins what nothing else
  /// does.
  virtual bool within_parts() const { return false; }
  /// How far nodes may go from where they were at begin() before a row does anything, model units; 0: it may do so
  /// there.
  virtual double reach(std::size_t) const { return 0; }
  /// The energy of a row that has gone so far, J.
  virtual double energy(std::size_t r, const Vec3& way) const = 0;
  struct Push {
    Vec3 force = Vec3::Zero();      ///< −∂E/∂way, N; each node gets that times its weight
    Mat3 curvature = Mat3::Zero();  ///< ∂²E/∂way², N/m, or more; never negative
  };
  /// What such a row does. Rows can be asked for by several threads, each by one.
  virtual Push push(std::size_t r, const Vec3& way) = 0;

  /// The most that a row's curvature may come to, N/m; 0: it does not act in the explicit step.
  virtual double stiffness(std::size_t) const { return 0; }
  /// Of these, where nodes that are held have no inverse mass: the largest sum of absolute values in a row of M⁻¹ Σ k w
  /// wᵀ, no less than the largest eigenvalue of M⁻¹ ∂²E/∂u², 1/s²; 0: there are none.
  double stiffest(const std::vector<double>& inverse_mass) const;
  /// Changes velocities by what it does in h seconds from displacements u on.
  virtual void impulse(const std::vector<Vec3>&, double /*h*/, const std::vector<double>& /*inverse_mass*/,
                       std::vector<Vec3>& /*velocity*/) {}
};

}  // namespace geo
