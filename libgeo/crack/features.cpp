// A feature edge has ≠ 2 faces, or two of different surfaces, or a crease: n₁ · n₂ < cos(crease)
// |n₁||n₂|. A vertex lies on all surfaces of its faces and on the lines of its feature edges.
#include "crack/features.h"

#include <algorithm>
#include <cmath>

#include "geometry/distance.h"
#include "surface/radial_edge.h"

namespace geo::crack {
namespace {

// True when two faces at edge ab are of different surfaces, or n_f · n_g < crease · |n_f| |n_g|
// with normals oriented alike across the edge.
bool is_feature_between(const Complex& k, FaceId ff, FaceId gg, VertexId a, VertexId b, const FeatureRules& rules) {
  const auto &f = k.face(ff), &g = k.face(gg);
  if (f.crack != g.crack || (f.crack == 0 && rules.keep_skin && f.source != g.source)) return true;
  const auto p = k.corners(ff), q = k.corners(gg);
  const Vec3 m = (p[1] - p[0]).cross(p[2] - p[0]), n = (q[1] - q[0]).cross(q[2] - q[0]);
  const double turn = runs_upwards(f, a, b) == runs_upwards(g, a, b) ? -m.dot(n) : m.dot(n);
  return turn < rules.crease * std::sqrt(m.squaredNorm() * n.squaredNorm());
}

}  // namespace

bool is_feature_edge(const Complex& k, VertexId a, VertexId b, const FeatureRules& rules) {
  const auto cycle = k.faces_around(a, b);
  return cycle.size() != 2 || is_feature_between(k, cycle[0], cycle[1], a, b, rules);
}

SurfaceLocation location_of(const Complex& k, VertexId v, const FeatureRules& rules) {
  SurfaceLocation location;
  std::vector<std::pair<VertexId, FaceId>> spokes;  // the faces at v by the other ends of their edges
  for (const FaceId f : k.faces_at(v)) {
    const auto& face = k.face(f);
    if (face.crack == 0 && rules.keep_skin)
      location.sources.push_back(face.source);
    else
      location.cracks.push_back(face.crack);
    for (const VertexId w : face.v)
      if (w != v) spokes.push_back({w, f});
  }
  const auto sort_unique = [](auto& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  };
  sort_unique(location.sources);
  sort_unique(location.cracks);
  std::sort(spokes.begin(), spokes.end());
  for (std::size_t i = 0, end; i < spokes.size(); i = end) {
    for (end = i + 1; end < spokes.size() && spokes[end].first == spokes[i].first;) ++end;
    if (end != i + 2 || is_feature_between(k, spokes[i].second, spokes[i + 1].second, v, spokes[i].first, rules))
      location.features.push_back(spokes[i].first);
  }
  return location;
}

bool lies_within(const SurfaceLocation& some, const SurfaceLocation& all) {
  return std::includes(all.sources.begin(), all.sources.end(), some.sources.begin(), some.sources.end()) &&
         std::includes(all.cracks.begin(), all.cracks.end(), some.cracks.begin(), some.cracks.end());
}

std::optional<VertexId> next_on_line(const SurfaceLocation& location, VertexId a) {
  if (location.features.size() != 2) return {};
  if (location.features[0] == a) return location.features[1];
  if (location.features[1] == a) return location.features[0];
  return {};
}

std::optional<double> distance_off_line(const Complex& k, const SurfaceLocation& location, VertexId b, VertexId a) {
  if (location.features.empty()) return 0.0;
  const auto c = next_on_line(location, a);
  if (!c) return {};
  return distance_between_segments(k.point(b), k.point(b), k.point(a), k.point(*c));
}

FrontContacts::FrontContacts(std::span<FrontState* const> fronts) : fronts_(fronts) {
  for (const FrontState* front : fronts)
    for (const auto& segment : front->segments)
      for (const auto& p : segment)
        if (p.id.valid()) contacts_.insert(p.id);
}

bool FrontContacts::may_omit(VertexId b, VertexId a) const {
  if (!contains(b)) return true;
  for (const FrontState* front : fronts_)
    for (const auto& segment : front->segments)
      for (std::size_t i = 0; i < segment.size(); ++i)
        if (segment[i].id == b &&
            (i == 0 || i + 1 == segment.size() || (segment[i - 1].id != a && segment[i + 1].id != a)))
          return false;
  return true;
}

void FrontContacts::omit(VertexId b) {
  if (!contacts_.erase(b)) return;
  for (FrontState* front : fronts_)
    for (auto& segment : front->segments) std::erase_if(segment, [&](const auto& p) { return p.id == b; });
}

}  // namespace geo::crack
