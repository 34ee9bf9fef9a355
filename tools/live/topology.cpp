// Dead ids give their slots back first; living ones without a slot then take the lowest free one.
// The cost of a change is linear in the ids of the complex, a fraction of a millisecond.
#include "live/topology.h"

#include <algorithm>
#include <functional>

namespace live {

TopologyChange change_between(const Topology& from, const Topology& to) {
  TopologyChange change;
  const auto is_empty = [](const Topology& t, std::size_t slot) {
    return slot >= t.triangle.size() || t.triangle[slot][0] == t.triangle[slot][1];
  };
  for (std::uint32_t s = 0; s < std::max(from.triangle.size(), to.triangle.size()); ++s) {
    if (is_empty(to, s)) {
      if (!is_empty(from, s)) change.removed.push_back(s);
    } else if (is_empty(from, s) || from.triangle[s] != to.triangle[s] || from.patch[s] != to.patch[s]) {
      change.added.push_back(s);
    }
  }
  for (std::uint32_t v = 0; v < to.rest.size(); ++v)
    if (v >= from.rest.size() || from.rest[v] != to.rest[v]) change.placed.push_back(v);
  return change;
}

void Slots::clear() {
  seen_ = {none, none, none};
  vertex_slot_.clear();
  side_slot_.clear();
  side_of_slot_.clear();
  painted_side_.clear();
  free_vertices_.clear();
  free_faces_.clear();
  vertex_slots_ = 0;
}

std::optional<std::uint32_t> Slots::slot(geo::SurfaceVertexId vertex) const {
  if (vertex.index() >= vertex_slot_.size() || vertex_slot_[vertex.index()] == none) return {};
  return vertex_slot_[vertex.index()];
}

geo::Side Slots::side(std::uint32_t slot) const {
  if (slot >= side_of_slot_.size() || side_of_slot_[slot] == none) return {};
  return {geo::FaceId(side_of_slot_[slot] / 2), static_cast<int>(side_of_slot_[slot] % 2)};
}

namespace {

// The lowest free slot, or a new one. `free` is descending.
std::uint32_t take(std::vector<std::uint32_t>& free, std::uint32_t& count) {
  if (free.empty()) return count++;
  const std::uint32_t slot = free.back();
  free.pop_back();
  return slot;
}

}  // namespace

// Triangles, patches and paint of a topology. Slots that have kept their side keep their paint.
void Slots::fill(Topology& next, const geo::Complex& complex, const Painter& painter) const {
  const std::size_t faces = side_of_slot_.size();
  next.triangle.assign(faces, {0, 0, 0});
  next.patch.assign(faces, 0);
  if (!painter.empty()) next.paint.resize(faces);
  std::vector<geo::Side> fresh;
  std::vector<std::uint32_t> fresh_slot;
  for (std::uint32_t slot = 0; slot < faces; ++slot) {
    const geo::Side side = this->side(slot);
    if (!side.face.valid()) continue;
    geo::Triangle& t = next.triangle[slot];
    for (int k = 0; k < 3; ++k) t[static_cast<std::size_t>(k)] = vertex_slot_[complex.surface_vertex(side, k).index()];
    if (side.which == 1) std::swap(t[1], t[2]);
    next.patch[slot] = static_cast<std::uint8_t>(std::min(complex.face(side.face).crack, 255));
    if (painter.empty() || next.patch[slot] != 0) continue;
    const bool was = topology_ && slot < topology_->paint.size() && slot < painted_side_.size() &&
                     painted_side_[slot] == side_of_slot_[slot];
    if (was) {
      next.paint[slot] = topology_->paint[slot];
    } else {
      fresh.push_back(side);
      fresh_slot.push_back(slot);
    }
  }
  const std::vector<TrianglePaint> paint = painter.paint(complex, fresh);
  for (std::size_t i = 0; i < fresh.size(); ++i) next.paint[fresh_slot[i]] = paint[i];
  next.rest.assign(vertex_slots_, Eigen::Vector3f::Zero());
  for (std::uint32_t v = 0; v < vertex_slot_.size(); ++v)
    if (vertex_slot_[v] != none)
      next.rest[vertex_slot_[v]] = complex.point(complex.site(geo::SurfaceVertexId(v))).cast<float>();
}

bool Slots::update(const geo::Complex& complex, const Painter& painter) {
  const std::array<std::uint32_t, 3> now{complex.face_count(), complex.surface_vertex_count(),
                                         complex.live_face_count()};
  if (topology_ && now == seen_) return false;
  seen_ = now;
  vertex_slot_.resize(now[1], none);
  side_slot_.resize(2 * std::size_t(now[0]), none);
  for (std::uint32_t v = 0; v < now[1]; ++v)
    if (vertex_slot_[v] != none && !complex.alive(geo::SurfaceVertexId(v))) {
      free_vertices_.push_back(vertex_slot_[v]);
      vertex_slot_[v] = none;
    }
  for (std::uint32_t s = 0; s < side_slot_.size(); ++s)
    if (side_slot_[s] != none && !complex.alive(geo::FaceId(s / 2))) {
      free_faces_.push_back(side_slot_[s]);
      side_of_slot_[side_slot_[s]] = none;
      side_slot_[s] = none;
    }
  std::sort(free_vertices_.begin(), free_vertices_.end(), std::greater<>());
  std::sort(free_faces_.begin(), free_faces_.end(), std::greater<>());
  living_.clear();
  for (std::uint32_t v = 0; v < now[1]; ++v) {
    if (!complex.alive(geo::SurfaceVertexId(v))) continue;
    if (vertex_slot_[v] == none) vertex_slot_[v] = take(free_vertices_, vertex_slots_);
    living_.push_back(vertex_slot_[v]);
  }
  auto next = std::make_shared<Topology>();
  auto faces = static_cast<std::uint32_t>(side_of_slot_.size());
  for (std::uint32_t s = 0; s < side_slot_.size(); ++s)
    if (side_slot_[s] == none && complex.has({geo::FaceId(s / 2), static_cast<int>(s % 2)})) {
      side_slot_[s] = take(free_faces_, faces);
      side_of_slot_.resize(faces, none);
      side_of_slot_[side_slot_[s]] = s;
    }
  fill(*next, complex, painter);
  painted_side_ = side_of_slot_;
  next->vertices = vertex_slots_;
  next->revision = ++revision_;
  topology_ = std::move(next);
  return true;
}

}  // namespace live
