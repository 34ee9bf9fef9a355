// Distances from the faces of cracks, found through the triangle index of K.
#include "simulation/existing_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "body/locate.h"
#include "geometry/distance.h"
#include "simulation/mapped_places.h"

namespace geo {
namespace {

// The place of a sheet nearest to a point.
struct SheetPlace {
  Vec3 place, normal;
  double distance = std::numeric_limits<double>::infinity();

  // A point at a height over the sheet, `further` along it from p.
  Vec3 over(double height, const Vec3& p, double further) const {
    Vec3 along = place - p;
    along -= normal.dot(along) * normal;
    return place + height * normal + (along.isZero(0) ? Vec3(Vec3::Zero()) : Vec3(further * along.normalized()));
  }
  double height(const Vec3& p) const { return normal.dot(p - place); }
};

// Within `reach`, of the cracks that `accept` takes by their numbers; else at infinity.
template <class Accept>
SheetPlace nearest_sheet(const Complex& surface, const Vec3& p, double reach, const Accept& accept) {
  std::vector<FaceId> near;
  surface.faces_near(Box3{p, p}.grown(reach), near);
  SheetPlace nearest;
  for (const FaceId f : near) {
    if (!accept(surface.face(f).crack)) continue;
    const auto [a, b, c] = surface.corners(f);
    const Vec3 place = closest_point_on_triangle(p, a, b, c);
    const double distance = (place - p).norm();
    if (distance < std::min(reach, nearest.distance))
      nearest = {.place = place, .normal = (b - a).cross(c - a).normalized(), .distance = distance};
  }
  return nearest;
}

bool is_crack(std::int32_t crack) { return crack != 0; }

// The place farthest back on the straight way from `now` to `before` that is in the same air: that
// at `now`, or the first that the way comes to. `now` where it comes to none.
Vec3 place_in_air(const Complex& surface, const Vec3& now, const Vec3& before, double spacing) {
  constexpr double probe = 0.25;  // spacings between places that are looked at
  const double count = std::ceil((before - now).norm() / (probe * spacing));
  bool has_left = !is_inside(surface, now);
  Vec3 farthest = now;
  for (int k = 1; k <= count; ++k) {
    const Vec3 place = now + k / count * (before - now);
    const bool inside = is_inside(surface, place);
    if (inside && has_left) break;
    if (inside) continue;
    has_left = true;
    farthest = place;
  }
  return farthest;
}

// The marked index nearest to i; nothing where none is marked.
std::optional<std::size_t> nearest_marked(const std::vector<std::uint8_t>& marked, std::size_t i) {
  for (std::size_t d = 0; d < marked.size(); ++d) {
    if (d <= i && marked[i - d]) return i - d;
    if (i + d < marked.size() && marked[i + d]) return i + d;
  }
  return {};
}

}  // namespace

double distance_from_crack(const Complex& surface, std::int32_t crack, const Vec3& point, double reach) {
  return nearest_sheet(surface, point, reach, [crack](std::int32_t other) { return other == crack; }).distance;
}

double distance_from_front(const FrontState& front, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& segment : front.segments)
    for (std::size_t k = 0; k + 1 < segment.size(); ++k)
      least = std::min(least, distance_between_segments(point, point, segment[k].position, segment[k + 1].position));
  return least;
}

bool has_contact(const FrontState& front) {
  return std::any_of(front.segments.begin(), front.segments.end(), [](const auto& segment) {
    return std::any_of(segment.begin(), segment.end(), [](const auto& p) { return p.id.valid(); });
  });
}

ExistingCuts::ExistingCuts(const Complex& surface, std::span<const EdgeFront> fronts)
    : surface_(surface), fronts_(fronts) {
  for (const EdgeFront& edge : fronts)
    if (edge.front.has_moved) own_.push_back(edge.front.crack);
  std::sort(own_.begin(), own_.end());
  own_.erase(std::unique(own_.begin(), own_.end()), own_.end());
}

bool ExistingCuts::contain(const Vec3& place, double spacing) const {
  if (surface_.crack_count() == 0) return false;
  std::vector<FaceId> near;
  surface_.faces_near(Box3{place, place}.grown(beside_own_sheet * spacing), near);
  double nearest_own = std::numeric_limits<double>::infinity();
  for (const FaceId f : near) {
    const std::int32_t crack = surface_.face(f).crack;
    if (crack == 0) continue;
    const auto [a, b, c] = surface_.corners(f);
    const double distance = (closest_point_on_triangle(place, a, b, c) - place).norm();
    if (distance < resolved_by_front * spacing) return true;
    if (std::binary_search(own_.begin(), own_.end(), crack)) nearest_own = std::min(nearest_own, distance);
  }
  return nearest_own < beside_own_sheet * spacing && !is_ahead(place, nearest_own);
}

bool ExistingCuts::may_contain_between(const Vec3& from, const Vec3& to, double spacing) const {
  if (surface_.crack_count() == 0) return false;
  Box3 box{from, from};
  box.add(to);
  std::vector<FaceId> near;
  surface_.faces_near(box.grown(resolved_by_front * spacing), near);
  return std::any_of(near.begin(), near.end(), [&](FaceId f) { return surface_.face(f).crack != 0; });
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
  const Complex& surface = moved.body.surface;
  std::vector<std::uint8_t> is_whole;
  for (const EdgePoint& p : run) is_whole.push_back(is_inside(surface, p.material));
  const bool is_all_in_air = std::count(is_whole.begin(), is_whole.end(), 1) == 0;
  const MapAt start(moved, blade, before);
  const ExistingCuts cuts(surface, fronts);
  const MappedPlaces places(moved.body);
  InverseDeformation::VertexCache memory;
  std::vector<std::uint8_t> is_in_air(begin.size(), 0), is_in_cut(begin.size(), 0);
  std::vector<Vec3> rise(begin.size(), Vec3::Zero());  // of points in cuts, over the sheet
  for (std::size_t i = 0; i < begin.size(); ++i) {
    EdgePoint& p = begin[i];
    const Vec3 world = start.pose() * place_on(blade, p.at);
    const auto place = start.map().to_material(world, memory, &p.material);
    if (!place.in_support) {
      p.material = place_in_air(surface, p.material, start.map().to_material_of(p.node, world), p.spacing);
      continue;
    }
    if (is_all_in_air) continue;  // an edge that has left a cut for air cuts nothing
    is_in_air[i] = !is_inside(surface, place.position);
    if (is_in_air[i]) p.material = place.position;
    if (is_in_air[i] || !is_whole[i] || !cuts.contain(place.position, p.spacing)) continue;
    const SheetPlace sheet = nearest_sheet(surface, place.position, beside_own_sheet * p.spacing, is_crack);
    const double height = resolved_by_front * p.spacing;
    is_in_cut[i] = std::isfinite(sheet.distance);
    p.material = is_in_cut[i] ? sheet.over(height, p.material, 2 * height) : place.position;
    rise[i] = height * sheet.normal;
  }
  std::vector<Vec3> edge;
  for (std::size_t i = 0; i < begin.size(); ++i) {
    // Beside the skin, the front is as high over the sheet in air as it is inside.
    if (const auto k = nearest_marked(is_in_cut, i); k && is_in_air[i]) begin[i].material += rise[*k];
    edge.push_back(begin[i].material);
  }
  edge = places.resolved(edge);
  for (std::size_t i = 0; i < begin.size(); ++i) begin[i].material = edge[i];
  return begin;
}

std::vector<EdgePoint> entering(const MovedBody& moved, const Blade& blade, double before,
                                std::span<const EdgePoint> run, const EdgeFront& edge) {
  std::vector<EdgePoint> points;
  if (run.front().at >= edge.at.front() && run.back().at <= edge.at.back()) return points;
  const MapAt start(moved, blade, before);
  InverseDeformation::VertexCache memory;
  for (const EdgePoint& p : run) {
    if (p.at >= edge.at.front() && p.at <= edge.at.back()) continue;
    const auto place = start.map().to_material(start.pose() * place_on(blade, p.at), memory, &p.material);
    if (!place.in_support || is_inside(moved.body.surface, place.position)) continue;
    EdgePoint begin = p;
    begin.material = place.position;
    points.push_back(begin);
  }
  return points;
}

void cross_first(const Complex& surface, const FrontState& front, std::span<const double> spacing,
                 std::vector<Vec3>& to) {
  if (front.has_moved || surface.crack_count() == 0) return;
  std::vector<std::uint8_t> is_inner(to.size(), 0), begins_in_cut(to.size(), 0);
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Vec3& from = front.points[i].position;
    is_inner[i] = is_inside(surface, from);
    const SheetPlace sheet = nearest_sheet(surface, from, 1.5 * resolved_by_front * spacing[i], is_crack);
    begins_in_cut[i] = is_inner[i] && std::isfinite(sheet.distance);
    if (begins_in_cut[i]) to[i] = from - 2 * sheet.height(from) * sheet.normal;
  }
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto k = nearest_marked(begins_in_cut, i);
    if (k && !is_inner[i]) to[i] = front.points[i].position + (to[*k] - front.points[*k].position);
  }
}

}  // namespace geo
