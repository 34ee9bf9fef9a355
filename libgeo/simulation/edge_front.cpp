// Resampling by edge parameters: a new parameter duplicates the nearest point of the front before
// the step. A dropped one moves onto its neighbour during the step and is erased after it.
#include "simulation/edge_front.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace geo {
namespace {

bool has(std::span<const EdgePoint> points, double at) {
  return std::any_of(points.begin(), points.end(), [&](const EdgePoint& p) { return p.at == at; });
}

// Inserts a copy of point k, before or after it, and an empty segment between the two.
void duplicate_point(EdgeFront& edge, std::size_t k, bool before, double at) {
  const FrontState::Point p = edge.front.points[k];
  const auto index = static_cast<std::ptrdiff_t>(before ? k : k + 1);
  edge.front.points.insert(edge.front.points.begin() + index, p);
  edge.front.segments.insert(edge.front.segments.begin() + static_cast<std::ptrdiff_t>(k), {p, p});
  edge.at.insert(edge.at.begin() + index, at);
}

// The points of an edge, from the end of a front outwards, that do not go back: in the gap between
// two pieces, the map is that of either, beyond its wall.
std::vector<EdgePoint> unfolded(const Vec3& end, std::vector<EdgePoint> points) {
  if (points.empty()) return points;
  const Vec3 way = points.back().material - end;
  Vec3 last = end;
  std::vector<EdgePoint> onwards;
  for (const EdgePoint& p : points) {
    if (!((p.material - last).dot(way) > 0)) continue;
    onwards.push_back(p);
    last = p.material;
  }
  return onwards;
}

}  // namespace

EdgeFront begin_edge(std::span<const EdgePoint> points, std::int32_t crack, const std::string& name, bool closed) {
  std::vector<Vec3> material;
  EdgeFront edge;
  for (const EdgePoint& p : points) {
    material.push_back(p.material);
    edge.at.push_back(p.at);
  }
  edge.front = begin_front(material, closed, crack);
  edge.front.name = name;
  return edge;
}

const EdgePoint& nearest(std::span<const EdgePoint> points, double at) {
  return *std::min_element(points.begin(), points.end(), [&](const EdgePoint& a, const EdgePoint& b) {
    return std::abs(a.at - at) < std::abs(b.at - at);
  });
}

Vec3 place_on(const Blade& blade, double at) {
  const std::size_t n = blade.points.size(), i = std::min(static_cast<std::size_t>(at), n - 1);
  const double t = at - double(i);
  return t > 0 ? Vec3(blade.points[i] + t * (blade.points[(i + 1) % n] - blade.points[i])) : blade.points[i];
}

Vec3 direction_on(const Blade& blade, double at) {
  const std::size_t n = blade.points.size(), last = blade.closed ? n - 1 : n - 2;
  const std::size_t i = std::min(static_cast<std::size_t>(at), last);
  return blade.points[(i + 1) % n] - blade.points[i];
}

std::optional<Vec3> place_on(std::span<const EdgeFront> fronts, double at) {
  for (const EdgeFront& edge : fronts) {
    if (edge.at.empty() || at < edge.at.front() || at > edge.at.back()) continue;
    const auto k = static_cast<std::size_t>(std::lower_bound(edge.at.begin(), edge.at.end(), at) - edge.at.begin());
    const Vec3& q = edge.front.points[k].position;
    if (edge.at[k] == at) return q;
    const Vec3& p = edge.front.points[k - 1].position;
    return Vec3(p + (at - edge.at[k - 1]) / (edge.at[k] - edge.at[k - 1]) * (q - p));
  }
  return {};
}

EdgeFront refined(const EdgeFront& edge, std::span<const EdgePoint> next, std::vector<Vec3>& to) {
  EdgeFront result = edge;
  for (const EdgePoint& p : next) {
    const auto k =
        static_cast<std::size_t>(std::lower_bound(result.at.begin(), result.at.end(), p.at) - result.at.begin());
    if (k < result.at.size() && result.at[k] == p.at) continue;
    const bool after = k == result.at.size() || (k > 0 && p.at - result.at[k - 1] < result.at[k] - p.at);
    if (after)
      duplicate_point(result, k - 1, false, p.at);
    else
      duplicate_point(result, k, true, p.at);
  }
  to.clear();
  for (const double at : result.at) to.push_back(nearest(next, at).material);
  return result;
}

bool rests(const EdgeFront& edge, std::span<const EdgePoint> next) {
  std::vector<Vec3> mapped;
  const EdgeFront front = refined(edge, next, mapped);
  std::vector<double> spacing;
  for (const double at : front.at) spacing.push_back(nearest(next, at).spacing);
  return rests(front.front, mapped, spacing, mapped);
}

bool rests(const FrontState& front, std::span<const Vec3> mapped, std::span<const double> spacing,
           std::span<const Vec3> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Vec3& place = front.points[i].position;
    if (to[i] != place && !((mapped[i] - place).norm() < resolved_by_front * spacing[i])) return false;
  }
  return true;
}

void collapse(EdgeFront& edge, std::span<const EdgePoint> next) {
  auto [points, segments, at] = std::tie(edge.front.points, edge.front.segments, edge.at);
  for (std::size_t s = 0; s < segments.size() && segments.size() > 1;) {
    if (points[s].position != points[s + 1].position || (has(next, at[s]) && has(next, at[s + 1]))) {
      ++s;
      continue;
    }
    const std::size_t removed = has(next, at[s]) ? s + 1 : s;
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(removed));
    at.erase(at.begin() + static_cast<std::ptrdiff_t>(removed));
    segments.erase(segments.begin() + static_cast<std::ptrdiff_t>(s));
  }
}

EdgeFront part_of(const EdgeFront& edge, double from, double to) {
  const auto& points = edge.front.points;
  auto first = static_cast<std::size_t>(std::lower_bound(edge.at.begin(), edge.at.end(), from) - edge.at.begin());
  auto end = static_cast<std::size_t>(std::upper_bound(edge.at.begin(), edge.at.end(), to) - edge.at.begin());
  EdgeFront part;
  if (end <= first) return part;
  if (first > 0 && points[first].id.valid() && !points[first - 1].id.valid()) --first;
  if (end < points.size() && points[end - 1].id.valid() && !points[end].id.valid()) ++end;
  if (end < first + 2) return part;
  const auto cut = [](const auto& all, std::size_t a, std::size_t b) {
    return std::decay_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(a),
                                       all.begin() + static_cast<std::ptrdiff_t>(b));
  };
  part.front = edge.front;
  part.front.points = cut(edge.front.points, first, end);
  part.front.segments = cut(edge.front.segments, first, end - 1);
  part.at = cut(edge.at, first, end);
  return part;
}

EdgeFront joined(EdgeFront a, const EdgeFront& b) {
  a.front.segments.push_back({a.front.points.back(), b.front.points.front()});
  a.front.segments.insert(a.front.segments.end(), b.front.segments.begin(), b.front.segments.end());
  a.front.points.insert(a.front.points.end(), b.front.points.begin(), b.front.points.end());
  a.front.has_moved = a.front.has_moved || b.front.has_moved;
  a.front.step = std::max(a.front.step, b.front.step);
  a.at.insert(a.at.end(), b.at.begin(), b.at.end());
  return a;
}

EdgeFront grown(EdgeFront edge, std::span<const EdgePoint> points) {
  std::vector<EdgePoint> below, above;  // from the front outwards
  for (const EdgePoint& p : points) {
    if (p.at < edge.at.front()) below.insert(below.begin(), p);
    if (p.at > edge.at.back()) above.push_back(p);
  }
  below = unfolded(edge.front.points.front().position, std::move(below));
  above = unfolded(edge.front.points.back().position, std::move(above));
  std::reverse(below.begin(), below.end());
  const auto front_of = [&](const std::vector<EdgePoint>& part) {
    return begin_edge(part, edge.front.crack, edge.front.name, false);
  };
  if (below.size() >= 2) edge = joined(front_of(below), edge);
  if (above.size() >= 2) edge = joined(std::move(edge), front_of(above));
  return edge;
}

}  // namespace geo
