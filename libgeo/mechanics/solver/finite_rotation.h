// Finite rotations of free-floating islands. A Newton direction moves nodes along straight lines,
// which stretches a body that turns; a stiff body does not allow that. So free-floating islands
// turn along arcs.
#pragma once

#include <cstdint>
#include <vector>

#include "mechanics/solver/incremental_potential.h"
#include "mechanics/solver/rigid_motion.h"

namespace geo {

/// The rigid motions of free-floating islands in one time step.
class FiniteRotation {
 public:
  /// Refers to the potential. Islands with a fixed node do not move. An island of the nodal
  /// discretisation with a node that cannot tell a rotation from a strain (moment matrix without
  /// full rank) is only translated.
  explicit FiniteRotation(const IncrementalPotential& potential);

  /// Displacements after finite rigid motions of the free-floating islands. Each is the nearest, in
  /// the quadratic mean, to the straight motion from the start of the step to u. Empty if none
  /// turns noticeably. rotates[island] becomes 1 if a free-floating island in it does, else 0.
  std::vector<Vec3> predict(const std::vector<Vec3>& u, std::vector<char>& rotates) const;
  /// Per free-floating island: the rigid motion nearest to a direction from u on, zero where its
  /// angle is negligible.
  std::vector<RigidMotion> rotations(const std::vector<Vec3>& u, const std::vector<Vec3>& direction) const;
  /// Sets rotates[island] to 1 for islands with a nonzero angle in the result of rotations().
  void mark_rotating(const std::vector<RigidMotion>& rotations, std::vector<char>& rotates) const;
  /// Adds to a direction from u on the rigid motions that give untouched free-floating islands the
  /// momenta of inertia and loads alone. Internal forces do not change these; rounding and the
  /// residual of the solve must not either.
  void conserve_momentum(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<Vec3>& direction) const;
  /// The free-floating island of a node.
  std::uint32_t island_of(std::size_t node) const { return potential_.islands().free_of_nodes()[node]; }

 private:
  Vec3 position(std::size_t node, const std::vector<Vec3>& u) const;
  bool is_noticeable(const RigidMotion& motion, std::size_t free_island) const;

  const IncrementalPotential& potential_;
  std::vector<std::uint32_t> island_;  // per free-floating island: the island that it is part of
  std::vector<double> spacing_;        // per free-floating island: the least of its nodes'
  std::vector<Freedom> freedom_;       // per free-floating island, whatever touches it
};

}  // namespace geo
