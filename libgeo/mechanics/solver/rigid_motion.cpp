// With arms a and displacements d: the rotation nearest to Σ m (a + d) aᵀ (Kabsch 1976), and the
// angle θ that carries all angular momentum, J θ = Σ m a × d, with J the tensor of inertia.
#include "mechanics/solver/rigid_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "geometry/nearest_rotation.h"
#include "geometry/principal_inertia.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Sums over a set, with arms from the position of its first node.
struct Moments {
  double mass = 0;
  Vec3 arm = Vec3::Zero(), displacement = Vec3::Zero();
  Mat3 arm_arm = Mat3::Zero(), displacement_arm = Mat3::Zero();  // Σ m a aᵀ, Σ m d aᵀ
  void operator+=(const Moments& o) {
    mass += o.mass;
    arm += o.arm;
    displacement += o.displacement;
    arm_arm += o.arm_arm;
    displacement_arm += o.displacement_arm;
  }
};

RigidMotion motion_of(const Moments& sums, const Vec3& base, Freedom freedom) {
  RigidMotion motion;
  if (!(sums.mass > 0)) return motion;
  const Vec3 arm = sums.arm / sums.mass;
  motion.centre = base + arm;
  motion.translation = sums.displacement / sums.mass;
  // About the centre of mass.
  const Mat3 moment = sums.arm_arm / sums.mass - arm * arm.transpose(),
             product = sums.displacement_arm / sums.mass - motion.translation * arm.transpose();
  motion.radius = std::sqrt(std::max(0.0, moment.trace()));
  if (freedom == Freedom::translation || !(motion.radius > 0) || !product.allFinite()) return motion;
  const double rounding = 1e-9 * moment.trace();  // a moment below it is that of a line or plane
  const NearestRotation nearest = nearest_rotation(moment + product);
  // Eigen rounds a product that is assigned unlike one that is constructed. Runs of earlier
  // versions have the first.
  if (nearest.singular_values[1] > rounding) motion.rotation = nearest.u * nearest.sign * nearest.v.transpose();
  // Σ m a × d, from the antisymmetric part of Σ m d aᵀ.
  const Vec3 momentum(product(2, 1) - product(1, 2), product(0, 2) - product(2, 0), product(1, 0) - product(0, 1));
  const PrincipalInertia inertia(moment.trace() * Mat3::Identity() - moment);
  const Vec3 angle = inertia.angular_velocity(momentum, rounding);
  for (int k = 0; k < 3; ++k) motion.angle += angle[k] * inertia.axes.col(k);
  return motion;
}

}  // namespace

Vec3 RigidMotion::arc_correction(const Vec3& at, const Vec3& displacement, double share) const {
  const double size = angle.norm(), a = share * size;
  if (!(size > 0)) return Vec3::Zero();
  const Vec3 axis = angle / size;
  // Rodrigues' formula.
  const auto rotate = [&](const Vec3& arm, double sine) -> Vec3 {
    return sine * axis.cross(arm) + (1 - cosine(a)) * axis.cross(axis.cross(arm));
  };
  return rotate(at - centre, sine(a) - a) + rotate(share * (displacement - linearised(at)), sine(a));
}

std::vector<RigidMotion> rigid_motions(const std::vector<std::uint32_t>& set, const std::vector<Freedom>& freedom,
                                       const std::vector<double>& mass, const std::function<Vec3(std::size_t)>& from,
                                       const std::function<Vec3(std::size_t)>& displacement) {
  std::vector<Vec3> base(freedom.size());
  std::vector<char> seen(freedom.size(), 0);
  for (std::size_t i = 0; i < set.size(); ++i)
    if (!std::exchange(seen[set[i]], 1)) base[set[i]] = from(i);
  // Each run of nodes lists the sets that it has nodes of, in order of appearance, each with its
  // moments.
  constexpr std::size_t nodes_per_run = 1024;
  using RunMoments = std::vector<std::pair<std::uint32_t, Moments>>;
  std::vector<RunMoments> runs((set.size() + nodes_per_run - 1) / nodes_per_run);
  parallel_for(runs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      RunMoments& run = runs[r];
      for (std::size_t i = r * nodes_per_run; i < std::min(set.size(), (r + 1) * nodes_per_run); ++i) {
        const auto p = set[i];
        if (freedom[p] == Freedom::none) continue;
        auto entry = std::find_if(run.rbegin(), run.rend(), [&](const auto& e) { return e.first == p; });
        if (entry == run.rend()) {
          run.emplace_back(p, Moments());
          entry = run.rbegin();
        }
        const Vec3 arm = from(i) - base[p], d = displacement(i), weighted = mass[i] * d;
        entry->second += Moments{.mass = mass[i],
                                 .arm = mass[i] * arm,
                                 .displacement = weighted,
                                 .arm_arm = mass[i] * arm * arm.transpose(),
                                 .displacement_arm = weighted * arm.transpose()};
      }
    }
  });
  std::vector<Moments> sums(freedom.size());
  for (const auto& run : runs)
    for (const auto& [p, moments] : run) sums[p] += moments;
  std::vector<RigidMotion> motions(freedom.size());
  for (std::size_t p = 0; p < motions.size(); ++p) motions[p] = motion_of(sums[p], base[p], freedom[p]);
  return motions;
}

}  // namespace geo
