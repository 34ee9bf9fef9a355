// The nearest face of the skin decides which side is outside.
#include "simulation/mapped_places.h"

#include <vector>

#include "geometry/distance.h"

namespace geo {
namespace {

constexpr int bits_of_map = 33;  // see MappedPlaces::resolved()

}  // namespace

MappedPlaces::MappedPlaces(const Complex& surface)
    : surface_(surface), resolution_(surface.extent().diagonal(), bits_of_map) {}

Vec3 MappedPlaces::resolved(const Vec3& place) const {
  const Vec3 rounded = resolution_.rounded(place);
  double nearest = 2 * resolution_.unit();
  std::vector<FaceId> near;
  surface_.faces_near(Box3{rounded, rounded}.grown(nearest), near);
  Vec3 outwards = Vec3::Zero();
  for (const FaceId f : near) {
    if (surface_.face(f).crack != 0) continue;
    const auto [a, b, c] = surface_.corners(f);
    const double distance = (closest_point_on_triangle(rounded, a, b, c) - rounded).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    outwards = (b - a).cross(c - a).normalized();
  }
  return rounded + 10 * resolution_.unit() * outwards;
}

}  // namespace geo
