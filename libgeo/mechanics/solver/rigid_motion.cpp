#include "mechanics/solver/rigid_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/nearest_rotation.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// About the piece's first node.
struct Sums {
  double mass = 0;
  Vec3 arm = Vec3::Zero(), way = Vec3::Zero();
  Mat3 spread = Mat3::Zero(), moved = Mat3::Zero();
  void operator+=(const Sums& o) { mass += o.mass, arm += o.arm, way += o.way, spread += o.spread, moved += o.moved; }
};

RigidMotion motion_of(const Sums& sums, const Vec3& base, Freedom freedom) {
  RigidMotion motion;
  if (!(sums.mass > 0)) return motion;
  const Vec3 arm = sums.arm / sums.mass;
  motion.middle = base + arm, motion.way = sums.way / sums.mass;
  const Mat3 spread = sums.spread / sums.mass - arm * arm.transpose(),
             moved = sums.moved / sums.mass - motion.way * arm.transpose();
  motion.reach = std::sqrt(std::max(0.0, spread.trace()));
  if (freedom == Freedom::way || !(motion.reach > 0) || !moved.allFinite()) return motion;
  constexpr double thin = 1e-9;  // of the spread: what is rounding
  const NearestRotation nearest = nearest_rotation(spread + moved);
  if (nearest.singular_values[1] > thin * spread.trace()) motion.turn = nearest.rotation;
  // Of arm × way, and the inertia that it is against.
  const Vec3 momentum(moved(2, 1) - moved(1, 2), moved(0, 2) - moved(2, 0), moved(1, 0) - moved(0, 1));
  const Eigen::SelfAdjointEigenSolver<Mat3> inertia(Mat3(spread.trace() * Mat3::Identity() - spread));
  for (int k = 0; k < 3; ++k)
    if (const Vec3 axis = inertia.eigenvectors().col(k); inertia.eigenvalues()[k] > thin * spread.trace())
      motion.turning += axis.dot(momentum) / inertia.eigenvalues()[k] * axis;
  return motion;
}

}  // namespace

Vec3 RigidMotion::bend(const Vec3& at, const Vec3& displacement, double share) const {
  const double size = turning.norm(), angle = share * size;
  if (!(size > 0)) return Vec3::Zero();
  const Vec3 axis = turning / size;
  const auto across = [&](const Vec3& arm, double sine) -> Vec3 {
    return sine * axis.cross(arm) + (1 - std::cos(angle)) * axis.cross(axis.cross(arm));
  };
  return across(at - middle, std::sin(angle) - angle) + across(share * (displacement - straight(at)), std::sin(angle));
}

std::vector<RigidMotion> rigid_motions(const std::vector<std::uint32_t>& piece, const std::vector<Freedom>& freedom,
                                       const std::vector<double>& mass, const std::function<Vec3(std::size_t)>& from,
                                       const std::function<Vec3(std::size_t)>& way) {
  std::vector<Vec3> base(freedom.size());
  std::vector<char> seen(freedom.size(), 0);
  for (std::size_t i = 0; i < piece.size(); ++i)
    if (!std::exchange(seen[piece[i]], 1)) base[piece[i]] = from(i);
  // Runs of nodes have a list of the pieces they are of, in order.
  constexpr std::size_t run = 1024;
  std::vector<std::vector<std::pair<std::uint32_t, Sums>>> some((piece.size() + run - 1) / run);
  parallel_for(some.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t i = r * run; i < std::min(piece.size(), (r + 1) * run); ++i) {
        const auto p = piece[i];
        if (freedom[p] == Freedom::none) continue;
        auto at = std::find_if(some[r].rbegin(), some[r].rend(), [&](const auto& s) { return s.first == p; });
        if (at == some[r].rend()) some[r].emplace_back(p, Sums()), at = some[r].rbegin();
        const Vec3 arm = from(i) - base[p], moved = way(i), weighed = mass[i] * moved;
        at->second += Sums{mass[i], mass[i] * arm, weighed, mass[i] * arm * arm.transpose(), weighed * arm.transpose()};
      }
  });
  std::vector<Sums> sums(freedom.size());
  for (const auto& of_run : some)
    for (const auto& [p, sum] : of_run) sums[p] += sum;
  std::vector<RigidMotion> motions(freedom.size());
  for (std::size_t p = 0; p < motions.size(); ++p) motions[p] = motion_of(sums[p], base[p], freedom[p]);
  return motions;
}

}  // namespace geo
