// Distances from the faces of cracks, found through the triangle index of K.
#include "simulation/existing_cuts.h"

#include <algorithm>
#include <limits>

#include "body/locate.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "geometry/resolution.h"

namespace geo {
namespace {

// Distances from sheets, in node spacings: of any crack, as rests() has it; of the blade's own, as
// hold_retreating() has it.
constexpr double any_reach = 0.05;
constexpr double own_reach = 0.25;

}  // namespace

double distance_from_crack(const Complex& surface, std::int32_t crack, const Vec3& point, double reach) {
  std::vector<FaceId> near;
  surface.faces_near(Box3{point, point}.grown(reach), near);
  double least = std::numeric_limits<double>::infinity();
  for (const FaceId f : near) {
    if (surface.face(f).crack != crack) continue;
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

ExistingCuts::ExistingCuts(const Body& body, std::span<const EdgeFront> fronts) : body_(body), fronts_(fronts) {
  for (const EdgeFront& edge : fronts)
    if (edge.front.step > 0) own_.push_back(edge.front.crack);
  std::sort(own_.begin(), own_.end());
  own_.erase(std::unique(own_.begin(), own_.end()), own_.end());
}

bool ExistingCuts::contain(const Vec3& place, NodeId node) const {
  const Complex& surface = body_.surface;
  if (surface.crack_count() == 0) return false;
  const double spacing = body_.nodes.spacing[node.index()];
  const Vec3& seen_from = body_.nodes.position[node.index()];
  Box3 box{place, place};
  box.add(seen_from);
  std::vector<FaceId> near;
  surface.faces_near(box.grown(own_reach * spacing), near);
  double nearest_own = std::numeric_limits<double>::infinity();
  for (const FaceId f : near) {
    const std::int32_t crack = surface.face(f).crack;
    if (crack == 0) continue;
    const auto [a, b, c] = surface.corners(f);
    const double distance = (closest_point_on_triangle(place, a, b, c) - place).norm();
    if (distance < any_reach * spacing || segment_meets_triangle(seen_from, place, a, b, c)) return true;
    if (std::binary_search(own_.begin(), own_.end(), crack)) nearest_own = std::min(nearest_own, distance);
  }
  return nearest_own < own_reach * spacing && !is_ahead(place, nearest_own);
}

bool ExistingCuts::is_ahead(const Vec3& place, double distance) const {
  return std::any_of(fronts_.begin(), fronts_.end(), [&](const EdgeFront& edge) {
    return has_contact(edge.front) && distance_from_front(edge.front, place) <= 2 * distance;
  });
}

bool ExistingCuts::can_go_on(double at) const {
  return std::any_of(fronts_.begin(), fronts_.end(), [&](const EdgeFront& edge) {
    return !edge.at.empty() && at >= edge.at.front() && at <= edge.at.back() && has_contact(edge.front);
  });
}

std::vector<EdgePoint> begin_of_run(const MovedBody& moved, const Blade& blade, double before,
                                     std::span<const EdgePoint> run, std::span<const EdgeFront> fronts) {
  std::vector<EdgePoint> begin(run.begin(), run.end());
  if (moved.body.surface.crack_count() == 0) return begin;
  const MapAt start(moved, blade, before);
  const ExistingCuts cuts(moved.body, fronts);
  const Resolution resolution(moved.body.surface.extent().diagonal());
  InverseDeformation::VertexCache memory;
  for (EdgePoint& p : begin) {
    const auto place = start.map().to_material(start.pose() * place_on(blade, p.at), memory, &p.material);
    if (!place.in_support) continue;
    if (cuts.contain(place.position, place.nearest) || !is_inside(moved.body.surface, place.position))
      p.material = resolution.rounded(place.position);
  }
  return begin;
}

}  // namespace geo
