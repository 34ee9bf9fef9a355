// Projection of separation constraints: changes the end of a straight motion until triangles that
// would pass through each other do not (position-based dynamics, Müller et al. 2007).
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "contact/detection/simplex.h"
#include "contact/motion/rigid_zones.h"
#include "kerf/vec.h"

namespace geo {

struct CandidateAxes;

/// Constraints between pairs of triangles. The axis of each separates its pair at the start of the
/// motion and has to separate it at the end: then the pair does not meet in between.
/// Triangles that share vertices are constrained by their disjoint sub-simplices. Pairs without a
/// usable axis move in rigid impact zones.
class SeparationProjection {
 public:
  /// Indices of two triangles.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// No constraints yet. `start`: per vertex, where no triangles cross. `gap`: separation to be
  /// kept, model units; pairs that start nearer keep what they have. `still`: per vertex, 1 where
  /// it is not moved, unless a zone is made rigid; empty: none. Refers to all but the gap.
  SeparationProjection(const std::vector<Triangle>& triangles, const std::vector<Vec3>& start, double gap,
                       std::span<const std::uint8_t> still = {})
      : triangles_(triangles), start_(start), gap_(gap), still_(still), zones_(start.size()) {}

  /// Adds constraints for pairs that the motion from the start to `next` does not certify; replaces
  /// older constraints of the same pairs. The axis has the largest end separation among axes with
  /// start separation ≥ min(largest start separation, gap) / 2. A pair without such an axis (start
  /// separation > 0) is made rigid.
  void add(std::span<const Pair> pairs, const std::vector<Vec3>& next);
  /// Merges each pair, and all that move with it, into one rigid zone. Returns whether that changed
  /// anything.
  bool make_rigid(std::span<const Pair> pairs);
  /// Whether two triangles are in one zone: then they cannot pass each other.
  bool is_rigid(std::uint32_t s, std::uint32_t t) const { return zones_.contain(triangles_[s], triangles_[t]); }
  /// Number of vertices in rigid zones.
  std::size_t in_zones() const { return zones_.vertex_count(); }

  /// Moves `next`, per vertex, until all constraints hold, or for a number of sweeps: Gauss–Seidel
  /// in the order in which constraints were added, each moving both sides by the same least amount,
  /// or one by all of it where the other is still.
  /// Zones are made rigid after each sweep. Returns the number of evaluations of constraints;
  /// no sweep begins once this is `max_evaluations`.
  std::size_t project(std::vector<Vec3>& next, std::size_t max_evaluations = ~std::size_t(0)) const;

 private:
  struct Constraint {
    Simplex a, b;        // with less than three vertices, the first is repeated
    Vec3 axis;           // unit, from b to a; zero: none was found
    double separation;   // to be kept, model units
    std::uint32_t s, t;  // the triangles
  };
  void choose_axis(Constraint& c, const CandidateAxes& axes, std::size_t lane, const std::vector<Vec3>& next) const;
  bool is_still(const Simplex& simplex) const;

  const std::vector<Triangle>& triangles_;
  const std::vector<Vec3>& start_;
  double gap_;
  std::span<const std::uint8_t> still_;
  std::vector<Constraint> constraints_;
  std::unordered_map<std::uint64_t, std::size_t> first_of_pair_;  // index of each pair's first constraint
  RigidZones zones_;
};

}  // namespace geo
