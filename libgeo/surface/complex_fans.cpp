// FanBuilder of surface/complex_impl.h. A fan is a closed cycle of sides at a vertex: walk from
// side to side across the edges at it, each time to the other side of the same wedge of material. A
// rebuilt fan keeps the lowest unclaimed id that its corners had.
#include <algorithm>

#include "surface/complex_impl.h"
#include "surface/radial_edge.h"

namespace geo {

// Each side at v has a neighbour across either of its edges there, so a fan is a closed cycle of
// sides.
void Complex::FanBuilder::walk_fan(Side start, VertexId v, std::vector<SurfaceVertexId>& old_ids) {
  Fan fan{.lowest = start,
          .corner = 0,
          .first_corner = corners_.size(),
          .end_corner = 0,
          .first_candidate = candidates_.size(),
          .end_candidate = 0};
  Side s = start;
  for (int edge = corner_at(k_.face(s.face), v), k = edge;;) {
    corners_.push_back({s, k});
    if (s <= fan.lowest) {
      fan.lowest = s;
      fan.corner = k;
    }
    if (const auto old = k_.surface_vertex(s, k);
        old.valid() && (candidates_.size() == fan.first_candidate || candidates_.back() != old))
      candidates_.push_back(old);
    const VertexId far = k_.face(s.face).v[edge == k ? (k + 1) % 3 : edge];
    s = k_.neighbor(s, edge);
    if (s == start) break;
    k = corner_at(k_.face(s.face), v);
    edge = k_.face(s.face).v[(k + 1) % 3] == far ? (k + 2) % 3 : k;  // leave by the edge that was not entered by
  }
  const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(fan.first_candidate);
  std::sort(first, candidates_.end());
  candidates_.erase(std::unique(first, candidates_.end()), candidates_.end());
  old_ids.insert(old_ids.end(), candidates_.begin() + static_cast<std::ptrdiff_t>(fan.first_candidate),
                 candidates_.end());
  fan.end_corner = corners_.size();
  fan.end_candidate = candidates_.size();
  fans_.push_back(fan);
}

void Complex::FanBuilder::collect_fans(VertexId v, std::vector<SurfaceVertexId>& old_ids) {
  corners_.clear();
  candidates_.clear();
  fans_.clear();
  for (const FaceId f : k_.faces_at(v))
    for (int which = 0; which < side_count(k_.face(f)); ++which) {
      const Side start{f, which};
      if (std::none_of(corners_.begin(), corners_.end(), [&](const auto& c) { return c.first == start; }))
        walk_fan(start, v, old_ids);
    }
  // Fans with the lowest old ids choose first, so that the outcome does not depend on face order
  // alone.
  std::sort(fans_.begin(), fans_.end(), [&](const Fan& a, const Fan& b) {
    const auto ca = a.first_candidate == a.end_candidate ? SurfaceVertexId() : candidates_[a.first_candidate];
    const auto cb = b.first_candidate == b.end_candidate ? SurfaceVertexId() : candidates_[b.first_candidate];
    return ca != cb ? ca < cb : a.lowest < b.lowest;
  });
}

void Complex::FanBuilder::claim_id(const Fan& fan, VertexId v, CrackDelta* delta) {
  SurfaceVertexId id;
  for (auto c = fan.first_candidate; c < fan.end_candidate && !id.valid(); ++c)
    if (std::find(claimed_.begin(), claimed_.end(), candidates_[c]) == claimed_.end()) id = candidates_[c];
  const bool is_new = !id.valid();
  if (is_new) {
    id = SurfaceVertexId(k_.site_.size());
    k_.site_.push_back(v);
    k_.fan_side_.emplace_back();
    k_.fan_corner_.push_back(0);
  }
  claimed_.push_back(id);
  k_.site_[id.index()] = v;
  k_.fan_side_[id.index()] = fan.lowest;
  k_.fan_corner_[id.index()] = static_cast<std::uint8_t>(fan.corner);
  for (auto c = fan.first_corner; c < fan.end_corner; ++c) {
    const auto& [s, k] = corners_[c];
    k_.corner_vertex_[s.face.index() * 6 + s.which * 3 + k] = id;
  }
  if (!delta) return;
  if (is_new) {
    delta->new_surface_vertices.push_back(id);
    delta->copied_from.push_back(fan.first_candidate == fan.end_candidate ? SurfaceVertexId()
                                                                          : candidates_[fan.first_candidate]);
  } else {
    delta->touched_surface_vertices.push_back(id);
  }
}

void Complex::FanBuilder::rebuild(VertexId v, std::vector<SurfaceVertexId>& old_ids, CrackDelta* delta) {
  collect_fans(v, old_ids);
  claimed_.clear();
  for (const Fan& fan : fans_) claim_id(fan, v, delta);
  std::sort(old_ids.begin(), old_ids.end());
  old_ids.erase(std::unique(old_ids.begin(), old_ids.end()), old_ids.end());
  for (const auto id : old_ids)
    if (std::find(claimed_.begin(), claimed_.end(), id) == claimed_.end()) {
      k_.site_[id.index()] = VertexId();
      if (delta) delta->removed_surface_vertices.push_back(id);
    }
}

}  // namespace geo
