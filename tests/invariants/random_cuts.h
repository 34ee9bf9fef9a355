// Random cuts through a model: planes and curved sheets, partial and complete, in any number of
// steps.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/random.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/pieces.h"

namespace random_cuts {

/// Scales the campaigns: KERF_CASES=10 runs ten times as many.
inline int cases(int count) {
  const char* text = std::getenv("KERF_CASES");
  return count * std::max(1, text ? std::atoi(text) : 1);
}

/// A sheet: a polyline that is carried along a direction. Carried straight, any number of steps
/// sweeps the same sheet.
struct Cut {
  std::vector<geo::Vec3> start;
  geo::Vec3 way;
  bool complete = false;

  std::vector<geo::Vec3> at(double t) const {
    auto points = start;
    for (auto& p : points) p += t * way;
    return points;
  }
};

/// A cut near the middle of the box; half of them planes, half of them complete.
inline Cut make_cut(const geo::Box3& box, geo::Random& random) {
  using geo::Vec3;
  const double size = box.diagonal();
  const Vec3 n = random.direction();
  const Vec3 u = n.unitOrthogonal(), side = n.cross(u);
  const double turn = random.uniform(0, 6.28);
  const Vec3 along = std::cos(turn) * u + std::sin(turn) * side, way = n.cross(along);
  Vec3 middle = box.center();
  for (int i = 0; i < 3; ++i) middle[i] += random.uniform(-0.3, 0.3) * (box.hi - box.lo)[i];
  Cut cut;
  const bool curved = random.uniform() < 0.5;
  cut.complete = random.uniform() < 0.5;
  const double bend = curved ? random.uniform(0.02, 0.15) * size : 0.0, phase = random.uniform(0, 6.28);
  const int count = 2 + static_cast<int>(random.below(8));
  const double half = cut.complete ? 1.2 * size : random.uniform(0.1, 0.6) * size;
  for (int i = 0; i < count; ++i) {
    const double s = 2.0 * i / (count - 1) - 1;
    cut.start.push_back(middle + half * s * along - 1.2 * size * way + bend * std::sin(3 * s + phase) * n);
  }
  cut.way = (cut.complete ? 2.4 : random.uniform(0.8, 1.6)) * size * way;
  return cut;
}

/// Area of the skin.
inline double skin_area(const geo::Complex& k) {
  double sum = 0;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(geo::FaceId(f)) && k.face(geo::FaceId(f)).crack == 0) {
      const auto t = k.corners(geo::FaceId(f));
      sum += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    }
  return sum;
}

}  // namespace random_cuts
