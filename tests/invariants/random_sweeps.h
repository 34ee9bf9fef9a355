// Random fronts of every kind: sheets, rings, jagged ones, and ones through vertices, edges and
// faces of what they cut.
#pragma once

#include "geometry/distance.h"
#include "invariants/random_cuts.h"

namespace random_sweeps {

using namespace geo;

/// The nearest vertex, point of an edge or point of a face, where one is not far; else p.
inline Vec3 snapped(const Complex& k, const Vec3& p, Random& random) {
  std::vector<FaceId> near;
  k.faces_near(Box3{p, p}.grown(0.03 * k.extent().diagonal()), near);
  Vec3 best = p;
  double least = 1e300;
  const auto kind = random.below(3);
  const auto offer = [&](const Vec3& q) {
    if ((q - p).norm() < least) {
      least = (q - p).norm();
      best = q;
    }
  };
  for (const FaceId f : near) {
    const auto t = k.corners(f);
    for (int i = 0; i < 3; ++i) {
      if (kind == 0) offer(t[i]);
      if (kind == 1) offer(closest_point_on_triangle(p, t[i], t[(i + 1) % 3], t[i]));
    }
    if (kind == 2) offer(closest_point_on_triangle(p, t[0], t[1], t[2]));
  }
  return best;
}

/// The start of a front, and its position after each step.
struct Sweep {
  std::string kind;
  bool closed = false;
  std::vector<std::vector<Vec3>> rows;
};

/// That number of steps, or occasionally a few.
inline Sweep make_sweep(const Complex& k, Random& random, int usual = 12) {
  Sweep sweep;
  const double size = k.extent().diagonal();
  const int steps = random.below(3) ? usual : 1 + static_cast<int>(random.below(4));
  if (random.below(5) == 0) {
    sweep.kind = "ring";
    sweep.closed = true;
    const Vec3 way = random.direction(), u = way.unitOrthogonal(), v = way.cross(u);
    const Vec3 from = k.extent().center() + random.uniform(0, 0.3) * size * random.direction() - 0.8 * size * way;
    const int count = 3 + static_cast<int>(random.below(12));
    const double radius = random.uniform(0.02, 0.3) * size, length = random.uniform(0.5, 1.6) * size,
                 twist = random.uniform(-1, 1);
    for (int s = 0; s <= steps; ++s) {
      sweep.rows.emplace_back();
      for (int i = 0; i < count; ++i) {
        const double a = 6.283185307 * i / count + twist * s / steps;
        sweep.rows.back().push_back(from + length * s / steps * way + radius * (std::cos(a) * u + std::sin(a) * v));
      }
    }
  } else {
    auto cut = random_cuts::make_cut(k.extent(), random);
    sweep.kind = "sheet";
    for (int s = 0; s <= steps; ++s) sweep.rows.push_back(cut.at(double(s) / steps));
  }
  if (random.below(4) == 0) {
    sweep.kind = "jagged " + sweep.kind;
    for (auto& row : sweep.rows)
      for (Vec3& p : row) p += random.uniform(0, 0.02) * size * random.direction();
  }
  if (random.below(3) == 0) {
    sweep.kind = "snapped " + sweep.kind;
    for (auto& row : sweep.rows)
      for (Vec3& p : row) p = snapped(k, p, random);
  }
  return sweep;
}

}  // namespace random_sweeps
