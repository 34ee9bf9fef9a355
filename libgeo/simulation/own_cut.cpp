// Distances from the faces of a blade's cracks, found through the triangle index of K.
#include "simulation/own_cut.h"

#include <algorithm>
#include <limits>

#include "geometry/distance.h"

namespace geo {

double distance_from_cracks(const Complex& surface, std::span<const std::int32_t> cracks, const Vec3& point,
                            double reach) {
  std::vector<FaceId> near;
  surface.faces_near(Box3{point, point}.grown(reach), near);
  double least = std::numeric_limits<double>::infinity();
  for (const FaceId f : near) {
    if (!std::binary_search(cracks.begin(), cracks.end(), surface.face(f).crack)) continue;
    const auto [a, b, c] = surface.corners(f);
    least = std::min(least, (closest_point_on_triangle(point, a, b, c) - point).norm());
  }
  return least < reach ? least : std::numeric_limits<double>::infinity();
}

double distance_from_front(const FrontState& front, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& segment : front.segments)
    for (std::size_t k = 0; k + 1 < segment.size(); ++k)
      least = std::min(least, distance_between_segments(point, point, segment[k].position, segment[k + 1].position));
  return least;
}

bool has_contact(const FrontState& front) {
  return std::any_of(front.points.begin(), front.points.end(), [](const auto& p) { return p.id.valid(); });
}

OwnCut::OwnCut(const Complex& surface, std::span<const EdgeFront> fronts) : surface_(surface), fronts_(fronts) {
  for (const EdgeFront& edge : fronts)
    if (edge.front.step > 0) cracks_.push_back(edge.front.crack);
  std::sort(cracks_.begin(), cracks_.end());
  cracks_.erase(std::unique(cracks_.begin(), cracks_.end()), cracks_.end());
}

bool OwnCut::contains(const Vec3& place, double spacing) const {
  const double reach = 0.25 * spacing;  // as hold_retreating()
  const double distance = distance_from_cracks(surface_, cracks_, place, reach);
  if (!(distance < reach)) return false;
  return std::none_of(fronts_.begin(), fronts_.end(), [&](const EdgeFront& edge) {
    return has_contact(edge.front) && distance_from_front(edge.front, place) <= 2 * distance;
  });
}

bool OwnCut::can_go_on(double at) const {
  return std::any_of(fronts_.begin(), fronts_.end(), [&](const EdgeFront& edge) {
    return !edge.at.empty() && at >= edge.at.front() && at <= edge.at.back() && has_contact(edge.front);
  });
}

}  // namespace geo
