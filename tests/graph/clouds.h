// Sets of points of every kind that neighbour searches meet.
#pragma once

#include <cmath>
#include <vector>

#include "base/random.h"

/// Even, graded, clustered, on lines and planes, on a lattice, at few places, far from the origin,
/// of extreme size.
constexpr int cloud_kinds = 12;
inline std::vector<geo::Vec3> cloud(geo::Random& random, int kind, int count) {
  using geo::Vec3;
  const auto any = [&] { return Vec3(random.uniform(), random.uniform(), random.uniform()); };
  const Vec3 normal = random.direction();
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(double(count))));
  std::vector<Vec3> centers;
  for (int c = 0; c < 4; ++c) centers.push_back(1e6 * any());
  std::vector<Vec3> p;
  for (int i = 0; i < count; ++i) {
    const double level = std::exp2(-double(random.below(60)));
    switch (kind) {
      case 0:
        p.push_back(any());
        break;
      case 1:
        p.push_back(level * any());
        break;  // graded towards a corner
      case 2:
        p.push_back(centers[random.below(4)] + std::exp2(-double(random.below(40))) * random.direction());
        break;
      case 3:
        p.push_back(any().x() * normal + Vec3(7, 8, 9));
        break;  // about a line
      case 4:
        p.push_back(Vec3(random.uniform(), random.uniform(), 0.3));
        break;
      case 5:
        p.push_back(Vec3(random.below(side), random.below(side), random.below(side)));
        break;  // ties, duplicates
      case 6:
        p.push_back(Vec3::Constant(random.below(3)));
        break;  // three places
      case 7:
        p.push_back(Vec3(1e9, -1e9, 1e9) + 1e-6 * any());
        break;
      case 8:
        p.push_back(1e55 * any());
        break;
      case 9:
        p.push_back(1e-170 * any());
        break;  // squares underflow
      case 10:
        p.push_back(i % 2 ? any() : Vec3(0.5, 0.5, 0.5));
        break;  // half at one place
      default:
        p.push_back(random.direction());
        break;
    }
  }
  return p;
}
