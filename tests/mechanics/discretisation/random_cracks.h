// Cracks that grow at random through a block, for tests of what follows its faces.
#pragma once

#include <span>
#include <vector>

#include "base/random.h"
#include "geometry/bvh.h"
#include "kerf/complex.h"
#include "mechanics/bodies.h"

namespace geo {

/// The living faces of a surface.
inline std::vector<FaceId> living_faces(const Complex& surface) {
  std::vector<FaceId> faces;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (surface.alive(FaceId(f))) faces.push_back(FaceId(f));
  return faces;
}

/// A tree over some faces.
inline TriangleBvh tree_over(const Complex& surface, std::span<const FaceId> faces) {
  std::vector<std::array<Vec3, 3>> corners;
  for (const FaceId f : faces) corners.push_back(surface.corners(f));
  return TriangleBvh(corners);
}

/// Grows cracks down through the unit block `surface`, each in some steps of a height from `least`
/// to `most`. A quarter of the steps is undone. Calls visit(front, delta) after each step, with an
/// empty delta for those undone.
template <class Visit>
void grow_cracks(Complex& surface, Random& random, int cracks, int steps, double least, double most,
                 const Visit& visit) {
  for (int crack = 1; crack <= cracks; ++crack) {
    const Vec3 a(random.uniform(0.2, 0.8), -0.2, 1.1), b(random.uniform(0.2, 0.8), 1.2, 1.1);
    const Vec3 step(random.uniform(-0.05, 0.05), 0, -random.uniform(least, most));
    auto front = begin_front(blade_at(a, b, step, 0, 5), false, crack);
    for (int k = 1; k <= steps; ++k) {
      const FrontState before = front;
      CrackDelta delta = advance(surface, front, blade_at(a, b, step, k, 5));
      if (!delta.empty() && random.below(4) == 0) {
        surface.undo();
        front = before;
        delta = {};
      }
      visit(front, delta);
    }
  }
}

}  // namespace geo
