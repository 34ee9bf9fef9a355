// Rigid motions per free-floating island from mass-weighted moments of its nodes
// (rigid_motion.cpp). Momentum: the direction gets the rigid motion nearest to what it lacks of the
// ballistic one.
#include "mechanics/solver/finite_rotation.h"

#include <algorithm>
#include <limits>

#include "kerf/parallel.h"
#include "mechanics/solver/fixed_nodes.h"

namespace geo {

FiniteRotation::FiniteRotation(const IncrementalPotential& potential) : potential_(potential) {
  const SolidDiscretisation& solid = potential.problem().solid;
  const Islands& islands = potential.islands();
  island_.resize(islands.free_count());
  spacing_.assign(islands.free_count(), std::numeric_limits<double>::max());
  freedom_.assign(islands.free_count(), Freedom::rigid);
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const auto f = island_of(i);
    island_[f] = islands.of(i);
    spacing_[f] = std::min(spacing_[f], solid.spacing[i]);
    if (is_fixed(potential.problem().environment, i))
      freedom_[f] = Freedom::none;
    else if (freedom_[f] == Freedom::rigid && !solid.galerkin && solid.mls.quality(i) != MomentQuality::good)
      freedom_[f] = Freedom::translation;
  }
}

Vec3 FiniteRotation::position(std::size_t node, const std::vector<Vec3>& u) const {
  return potential_.problem().solid.position[node] + u[node];
}

// Whether the straight lines of a rotation by angle a, which stretch lengths by √(1 + a²) − 1 ≈ ½
// a², do so noticeably over the radius of gyration.
bool FiniteRotation::is_noticeable(const RigidMotion& motion, std::size_t free_island) const {
  constexpr double noticeable = 1e-4;  // spacings; a tenth of the default accuracy of displacements
  return 0.5 * motion.angle.squaredNorm() * motion.radius > noticeable * spacing_[free_island];
}

std::vector<Vec3> FiniteRotation::predict(const std::vector<Vec3>& u, std::vector<char>& rotates) const {
  const StepProblem& problem = potential_.problem();
  const Islands& islands = potential_.islands();
  const std::vector<Vec3>& start = problem.start.displacement;
  const auto from = [&](std::size_t i) -> Vec3 { return position(i, start); };
  const auto motion = rigid_motions(islands.free_of_nodes(), freedom_, problem.solid.mass, from,
                                    [&](std::size_t i) -> Vec3 { return u[i] - start[i]; });
  rotates.assign(islands.count(), 0);
  bool any = false;
  for (std::size_t f = 0; f < motion.size(); ++f)
    if (is_noticeable(motion[f], f)) rotates[island_[f]] = any = true;
  if (!any) return {};
  std::vector<Vec3> displacement = start;
  parallel_for(displacement.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (const auto f = island_of(i); freedom_[f] != Freedom::none) displacement[i] += motion[f].displacement(from(i));
  });
  return displacement;
}

std::vector<RigidMotion> FiniteRotation::rotations(const std::vector<Vec3>& u,
                                                   const std::vector<Vec3>& direction) const {
  auto motion = rigid_motions(
      potential_.islands().free_of_nodes(), freedom_, potential_.problem().solid.mass,
      [&](std::size_t i) -> Vec3 { return position(i, u); }, [&](std::size_t i) -> Vec3 { return direction[i]; });
  for (std::size_t f = 0; f < motion.size(); ++f)
    if (!is_noticeable(motion[f], f)) motion[f] = {};
  return motion;
}

void FiniteRotation::mark_rotating(const std::vector<RigidMotion>& rotations, std::vector<char>& rotates) const {
  for (std::size_t f = 0; f < rotations.size(); ++f)
    if (!rotations[f].angle.isZero(0)) rotates[island_[f]] = 1;
}

void FiniteRotation::conserve_momentum(const ActiveIslands& active, const std::vector<Vec3>& u,
                                       std::vector<Vec3>& direction) const {
  const SolidDiscretisation& solid = potential_.problem().solid;
  std::vector<Freedom> freedom = freedom_;
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (Freedom& f = freedom[island_of(i)]; f != Freedom::none)
      if (!active[potential_.islands().of(i)] || potential_.is_touched(i)) f = Freedom::none;
  if (std::all_of(freedom.begin(), freedom.end(), [](Freedom f) { return f == Freedom::none; })) return;
  const auto at = [&](std::size_t i) -> Vec3 { return position(i, u); };
  const auto missing = [&](std::size_t i) -> Vec3 {
    const double squared = potential_.squared_time(potential_.islands().of(i));
    return potential_.inertial_target()[i] + squared / solid.mass[i] * potential_.load()[i] - u[i] - direction[i];
  };
  const auto motion = rigid_motions(potential_.islands().free_of_nodes(), freedom, solid.mass, at, missing);
  active.each_node([&](std::size_t i) {
    if (const auto f = island_of(i); freedom[f] != Freedom::none) direction[i] += motion[f].linearised(at(i));
  });
}

}  // namespace geo
