// The faces of the skin at a place decide which side is outside.
#include "simulation/mapped_places.h"

#include <vector>

#include "geometry/distance.h"

namespace geo {
namespace {

constexpr int bits_of_map = 33;  // see MappedPlaces::resolved()
// Cosine of normals of faces that lie in one plane, but for rounding: an angle of 1.4e-6.
constexpr double flat = 1 - 1e-12;

}  // namespace

MappedPlaces::MappedPlaces(const Complex& surface)
    : surface_(surface), resolution_(surface.extent().diagonal(), bits_of_map) {}

Vec3 MappedPlaces::resolved(const Vec3& place) const {
  const Vec3 rounded = resolution_.rounded(place);
  const double reach = 2 * resolution_.unit();
  std::vector<FaceId> near;
  surface_.faces_near(Box3{rounded, rounded}.grown(reach), near);
  Vec3 outwards = Vec3::Zero();
  for (const FaceId f : near) {
    if (surface_.face(f).crack != 0) continue;
    const auto [a, b, c] = surface_.corners(f);
    if ((closest_point_on_triangle(rounded, a, b, c) - rounded).norm() >= reach) continue;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    // An edge or vertex has no such direction, and a blade through it would leave its plane.
    if (!outwards.isZero(0) && outwards.dot(normal) < flat) return rounded;
    outwards = normal;
  }
  return rounded + 10 * resolution_.unit() * outwards;
}

}  // namespace geo
