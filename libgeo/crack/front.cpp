// resample_front() and substep_count() of kerf/crack.h. Resampling is linear along the polyline, at
// equal fractions of arc length. Substeps: ⌈max_i |next_i − previous_i| / limit⌉.
#include "kerf/crack.h"

#include <algorithm>
#include <cmath>

#include "kerf/error.h"

namespace geo {

std::vector<Vec3> resample_front(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, bool closed) {
  if (previous.size() == next.size()) return next;
  // Same fraction of arc length on both polylines.
  const auto lengths = [&](const std::vector<Vec3>& line) {
    std::vector<double> sum{0};
    for (std::size_t i = 1; i < line.size() + (closed ? 1 : 0); ++i)
      sum.push_back(sum.back() + (line[i % line.size()] - line[i - 1]).norm());
    return sum;
  };
  const auto from = lengths(previous), to = lengths(next);
  std::vector<Vec3> points;
  std::size_t segment = 0;
  for (std::size_t i = 0; i < previous.size(); ++i) {
    const double fraction = from.back() > 0 ? from[i] / from.back() : double(i) / double(previous.size());
    const double target = fraction * to.back();
    while (segment + 2 < to.size() && to[segment + 1] < target) ++segment;
    const double length = to[segment + 1] - to[segment];
    const double t = length > 0 ? std::clamp((target - to[segment]) / length, 0.0, 1.0) : 0.0;
    const Vec3 &a = next[segment % next.size()], &b = next[(segment + 1) % next.size()];
    points.push_back(t == 0 ? a : t == 1 ? b : Vec3(a + t * (b - a)));
  }
  return points;
}

int substep_count(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, double limit) {
  if (!(limit > 0)) throw InputError("the largest motion of a front point must be positive");
  double largest = 0;
  for (std::size_t i = 0; i < std::min(previous.size(), next.size()); ++i)
    largest = std::max(largest, (next[i] - previous[i]).norm());
  // 1e-12 forgives rounding of the quotient; at most a million, to fit an int.
  return std::max(1, static_cast<int>(std::min(1e6, std::ceil(largest / limit * (1 - 1e-12)))));
}

}  // namespace geo
