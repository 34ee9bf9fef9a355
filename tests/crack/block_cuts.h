// Partial cuts through a unit block, in sequence: for the test of remeshing and its benchmark.
#pragma once

#include <algorithm>
#include <vector>

#include "base/random.h"
#include "kerf/crack.h"

/// A front from a random point of the block's skin: its start and four steps.
inline std::vector<std::vector<geo::Vec3>> block_cut(geo::Random& random) {
  using geo::Vec3;
  Vec3 p(random.uniform(), random.uniform(), random.uniform());
  p[static_cast<int>(random.below(3))] = random.below(2);
  const Vec3 n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u);
  const double size = 0.5 * random.uniform(0.5, 1);
  std::vector<std::vector<Vec3>> rows(5);
  for (int s = 0; s <= 4; ++s)
    for (int i = 0; i <= 5; ++i)
      rows[static_cast<std::size_t>(s)].push_back(p + size * ((s / 4.0 - 0.5) * u + (i / 5.0 - 0.5) * v));
  return rows;
}

/// The first percentile of the faces' smallest angles, in degrees.
inline double low_angle(const geo::Complex& k) {
  std::vector<double> angles;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(geo::FaceId(f))) angles.push_back(geo::smallest_angle(k.corners(geo::FaceId(f))));
  const auto at = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 100);
  std::nth_element(angles.begin(), at, angles.end());
  return *at;
}
