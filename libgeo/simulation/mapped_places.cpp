// The faces of the skin at a place decide which side is outside.
#include "simulation/mapped_places.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/distance.h"

namespace geo {
namespace {

constexpr int bits_of_map = 33;  // see MappedPlaces::at()
// Cosine of normals of faces that lie in one plane, but for rounding: an angle of 1.4e-6.
constexpr double flat = 1 - 1e-12;
// Sine of the angle between a plane and an edge in it, but for rounding: places are exact to
// 1e-10 of the size, and the points of an edge some 1e-3 of it apart.
constexpr double level = 1e-6;

bool is_flat(const Vec3& n, const Vec3& m) { return !(n.dot(m) < flat); }

bool is_same(const MappedPlace::SkinPlane& a, const MappedPlace::SkinPlane& b) {
  return a.offset == b.offset && is_flat(a.normal, b.normal);
}

bool holds_edge(const MappedPlace::SkinPlane& plane) { return plane.edge == MappedPlace::Edge::in_plane; }

// Whether the place has a plane with this normal.
bool has(const MappedPlace& place, const Vec3& normal) {
  return std::any_of(place.planes.begin(), place.planes.end(),
                     [&](const auto& plane) { return is_flat(plane.normal, normal); });
}

}  // namespace

MappedPlaces::MappedPlaces(const Body& body)
    : surface_(body.surface),
      resolution_(body.surface.extent().diagonal(), bits_of_map),
      beside_skin_(body.finest_spacing),
      beyond_snapping_(2 * snap_spacings * body.finest_spacing) {}

MappedPlace MappedPlaces::at(const Vec3& place, const Vec3& along) const {
  MappedPlace result{resolution_.rounded(place), {}};
  const Vec3& p = result.rounded;
  std::vector<FaceId> near;
  surface_.faces_near(Box3{p, p}.grown(beside_skin_), near);
  for (const FaceId f : near) {
    if (surface_.face(f).crack != 0) continue;
    const auto [a, b, c] = surface_.corners(f);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    if (!(std::abs(normal.dot(p - a)) < reach())) continue;
    if (has(result, normal)) continue;
    const bool holds = std::abs(normal.dot(along)) <= level * along.norm();
    if (!holds && (closest_point_on_triangle(p, a, b, c) - p).norm() >= reach()) continue;
    result.planes.push_back({.normal = normal,
                             .offset = normal.dot(a),
                             .edge = holds ? MappedPlace::Edge::in_plane : MappedPlace::Edge::crosses});
  }
  if (result.planes.size() > 1) std::erase_if(result.planes, [&](const auto& plane) { return !holds_edge(plane); });
  return result;
}

void MappedPlaces::share_planes(std::span<MappedPlace> edge) const {
  std::vector<MappedPlace::SkinPlane> planes;
  for (const MappedPlace& place : edge)
    for (const auto& plane : place.planes)
      if (holds_edge(plane) &&
          std::none_of(planes.begin(), planes.end(), [&](const auto& known) { return is_same(known, plane); }))
        planes.push_back(plane);
  for (const auto& plane : planes)
    for (MappedPlace& place : edge)
      if (std::abs(plane.normal.dot(place.rounded) - plane.offset) < reach() && !has(place, plane.normal))
        place.planes.push_back(plane);
}

Vec3 MappedPlaces::outside(const MappedPlace& place) const {
  Vec3 result = place.rounded;
  for (const auto& plane : place.planes)
    result += (holds_edge(plane) ? beyond_snapping_ : 10 * resolution_.unit()) * plane.normal;
  return result;
}

std::vector<Vec3> MappedPlaces::resolved(std::span<const Vec3> edge) const {
  std::vector<MappedPlace> places;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, edge.size() - 1);
    places.push_back(at(edge[i], edge[after] - edge[before]));
  }
  share_planes(places);
  std::vector<Vec3> result;
  for (const MappedPlace& place : places) result.push_back(outside(place));
  return result;
}

}  // namespace geo
