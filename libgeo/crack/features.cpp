#include <algorithm>
#include <cmath>
#include <map>

#include "crack/features.h"
#include "geometry/distance.h"
#include "surface/radial_edge.h"

namespace geo::crack {
namespace {

std::array<Vec3, 3> corners_of(const Complex& k, const ComplexEdit& edit, const ComplexEdit::NewFace& f) {
  std::array<Vec3, 3> t;
  for (int i = 0; i < 3; ++i) t[i] = point_after(k, edit, f.v[i]);
  return t;
}

}  // namespace

double badness(const std::array<Vec3, 3>& t) {
  const double ab = (t[1] - t[0]).squaredNorm(), bc = (t[2] - t[1]).squaredNorm(), ca = (t[0] - t[2]).squaredNorm();
  const double area = (t[1] - t[0]).cross(t[2] - t[0]).norm();
  // The smallest angle is opposite to the shortest side.
  return 0.5 * (ab + bc + ca - 2 * std::min({ab, bc, ca})) / std::max(area, 1e-300);
}

namespace {

// True when the surface that two faces of one edge lie on ends or bends there.
bool is_feature_between(const Complex& k, FaceId ff, FaceId gg, VertexId a, VertexId b, const PlaceRules& rules) {
  const auto &f = k.face(ff), &g = k.face(gg);
  if (f.crack != g.crack || (f.crack == 0 && rules.skin_keeps && f.source != g.source)) return true;
  const auto p = k.corners(ff), q = k.corners(gg);
  const Vec3 m = (p[1] - p[0]).cross(p[2] - p[0]), n = (q[1] - q[0]).cross(q[2] - q[0]);
  const double turn = runs_upwards(f, a, b) == runs_upwards(g, a, b) ? -m.dot(n) : m.dot(n);
  return turn < rules.crease * std::sqrt(m.squaredNorm() * n.squaredNorm());
}

}  // namespace

bool is_feature(const Complex& k, VertexId a, VertexId b, const PlaceRules& rules) {
  const auto ring = k.faces_around(a, b);
  return ring.size() != 2 || is_feature_between(k, ring[0], ring[1], a, b, rules);
}

Place place_of(const Complex& k, VertexId v, const PlaceRules& rules) {
  Place place;
  std::vector<std::pair<VertexId, FaceId>> spokes;  // each face by the other ends of its edges at v
  for (const FaceId f : k.faces_at(v)) {
    const auto& face = k.face(f);
    if (face.crack == 0 && rules.skin_keeps)
      place.sources.push_back(face.source);
    else
      place.cracks.push_back(face.crack);
    for (const VertexId w : face.v)
      if (w != v) spokes.push_back({w, f});
  }
  const auto once = [](auto& row) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  };
  once(place.sources), once(place.cracks);
  std::sort(spokes.begin(), spokes.end());
  for (std::size_t i = 0, end; i < spokes.size(); i = end) {
    for (end = i + 1; end < spokes.size() && spokes[end].first == spokes[i].first;) ++end;
    if (end != i + 2 || is_feature_between(k, spokes[i].second, spokes[i + 1].second, v, spokes[i].first, rules))
      place.features.push_back(spokes[i].first);
  }
  return place;
}

bool lies_within(const Place& some, const Place& all) {
  return std::includes(all.sources.begin(), all.sources.end(), some.sources.begin(), some.sources.end()) &&
         std::includes(all.cracks.begin(), all.cracks.end(), some.cracks.begin(), some.cracks.end());
}

std::optional<VertexId> opposite(const Place& place, VertexId a) {
  if (place.features.size() != 2) return {};
  if (place.features[0] == a) return place.features[1];
  if (place.features[1] == a) return place.features[0];
  return {};
}

std::optional<double> distance_off_line(const Complex& k, const Place& place, VertexId b, VertexId a) {
  if (place.features.empty()) return 0.0;
  const auto c = opposite(place, a);
  if (!c) return {};
  return distance_between_segments(k.point(b), k.point(b), k.point(a), k.point(*c));
}

Contacts::Contacts(std::span<FrontState* const> fronts) : fronts_(fronts) {
  for (const FrontState* front : fronts)
    for (const auto& segment : front->segments)
      for (const auto& p : segment)
        if (p.id.valid()) held_.insert(p.id);
}

bool Contacts::may_leave_out(VertexId b, VertexId a) const {
  if (!holds(b)) return true;
  for (const FrontState* front : fronts_)
    for (const auto& segment : front->segments)
      for (std::size_t i = 0; i < segment.size(); ++i)
        if (segment[i].id == b &&
            (i == 0 || i + 1 == segment.size() || (segment[i - 1].id != a && segment[i + 1].id != a)))
          return false;
  return true;
}

void Contacts::leave_out(VertexId b) {
  if (!held_.erase(b)) return;
  for (FrontState* front : fronts_)
    for (auto& segment : front->segments) std::erase_if(segment, [&](const auto& p) { return p.id == b; });
}

double distance_left(const Complex& k, const LocalEdit& local, const Vec3& p, const PlaceRules& rules) {
  std::map<std::int32_t, double> nearest;
  for (const auto& f : local.edit.new_faces) {
    if (f.crack == 0 && rules.skin_keeps) continue;
    const auto t = corners_of(k, local.edit, f);
    const double d = (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
    const auto [it, fresh] = nearest.try_emplace(f.crack, d);
    if (!fresh) it->second = std::min(it->second, d);
  }
  double most = 0;
  for (const auto& [crack, d] : nearest) most = std::max(most, d);
  return most;
}

std::pair<double, double> worst_if_moved(const Complex& k, VertexId v, const Vec3& p, VertexId into) {
  double before = 0, after = 0;
  for (const FaceId f : k.faces_at(v)) {
    auto t = k.corners(f);
    before = std::max(before, badness(t));
    if (into.valid() && corner_at(k.face(f), into) >= 0) continue;
    t[static_cast<std::size_t>(corner_at(k.face(f), v))] = p;
    after = std::max(after, badness(t));
  }
  return {before, after};
}

double worst_old(const Complex& k, const LocalEdit& local) {
  double bad = 0;
  for (const FaceId f : local.edit.removed_faces) bad = std::max(bad, badness(k.corners(f)));
  return bad;
}

double worst_new(const Complex& k, const LocalEdit& local) {
  double bad = 0;
  for (const auto& f : local.edit.new_faces) bad = std::max(bad, badness(corners_of(k, local.edit, f)));
  return bad;
}

}  // namespace geo::crack
