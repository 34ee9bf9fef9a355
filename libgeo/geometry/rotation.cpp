// A quaternion is (cos ½φ, sin ½φ n). Those of opposite sign are the same rotation; the way between
// two is shortest where their product is positive.
#include "geometry/rotation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"

namespace geo {

Eigen::Quaterniond rotation_about(const Vec3& axis, double angle) {
  Eigen::Quaterniond rotation;
  rotation.w() = cosine(0.5 * angle);
  rotation.vec() = sine(0.5 * angle) * axis;
  return rotation;
}

Eigen::AngleAxisd axis_and_angle(const Eigen::Quaterniond& rotation) {
  const double n = rotation.vec().stableNorm();
  if (!(n > 0)) return {0, Vec3::UnitX()};
  const double sign = rotation.w() < 0 ? -1 : 1;
  return {2 * angle_of(n, std::abs(rotation.w())), sign / n * rotation.vec()};
}

Eigen::Quaterniond rotation_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share) {
  constexpr double nearly_one =
      1 - std::numeric_limits<double>::epsilon();  // a product: the sine of the way is rounding
  const double product = a.dot(b), cosine_of_way = std::abs(product);
  double of_a = 1 - share, of_b = share;
  if (cosine_of_way < nearly_one) {
    const double way = arc_cosine(cosine_of_way), sine_of_way = sine(way);
    of_a = sine((1 - share) * way) / sine_of_way;
    of_b = sine(share * way) / sine_of_way;
  }
  if (product < 0) of_b = -of_b;
  return Eigen::Quaterniond(of_a * a.coeffs() + of_b * b.coeffs());
}

}  // namespace geo
