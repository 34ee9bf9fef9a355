// A disk, to be pressed.
#pragma once

#include <cmath>
#include <numbers>

#include "kerf/mesh.h"

namespace geo {

/// A disk about the y axis, of diameter 1, from 0 to 1 along x and z: a square whose rings become
/// circles (Shirley and Chiu 1997).
inline TriangleMesh make_disk(double thickness, double edge) {
  TriangleMesh mesh = make_block({1, thickness, 1}, edge);
  for (Vec3& p : mesh.vertices) {
    const double a = 2 * p.x() - 1, b = 2 * p.z() - 1, r = std::max(std::abs(a), std::abs(b));
    if (!(r > 0)) continue;
    const double turn = std::numbers::pi / 4 * (std::abs(a) >= std::abs(b) ? b / a : a / b);
    const Vec2 along = std::abs(a) >= std::abs(b) ? Vec2(std::cos(turn), std::sin(turn)) * (a / r)
                                                  : Vec2(std::sin(turn), std::cos(turn)) * (b / r);
    p = {0.5 + 0.5 * r * along.x(), p.y(), 0.5 + 0.5 * r * along.y()};
  }
  return mesh;
}

}  // namespace geo
