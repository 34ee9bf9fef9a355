// Sets of ids: an item removed after it was made is erased from the new ones, any other removed
// item is recorded. Origins of copied surface vertices are composed along the deltas.
#include "surface/delta_sum.h"

#include <algorithm>

namespace geo {

void DeltaSum::add(const CrackDelta& delta) {
  new_vertices_.insert(new_vertices_.end(), delta.new_vertices.begin(), delta.new_vertices.end());
  for (const FaceId f : delta.removed_faces) {
    new_crack_faces_.erase(f);
    if (!new_faces_.erase(f)) removed_faces_.insert(f);
  }
  new_faces_.insert(delta.new_faces.begin(), delta.new_faces.end());
  new_crack_faces_.insert(delta.new_crack_faces.begin(), delta.new_crack_faces.end());
  // A copy of what an earlier delta made copies what that was a copy of.
  for (std::size_t i = 0; i < delta.new_surface_vertices.size(); ++i) {
    const auto from = new_.find(delta.copied_from[i]);
    new_[delta.new_surface_vertices[i]] = from == new_.end() ? delta.copied_from[i] : from->second;
  }
  for (const SurfaceVertexId v : delta.removed_surface_vertices) {
    touched_.erase(v);
    if (!new_.erase(v)) removed_.insert(v);
  }
  for (const SurfaceVertexId v : delta.touched_surface_vertices)
    if (!new_.count(v)) touched_.insert(v);
}

CrackDelta DeltaSum::sum() const {
  CrackDelta delta;
  const auto list = [](const auto& set, auto& out) {
    out.assign(set.begin(), set.end());
    std::sort(out.begin(), out.end());
  };
  delta.new_vertices = new_vertices_;
  list(removed_faces_, delta.removed_faces);
  list(new_faces_, delta.new_faces);
  list(new_crack_faces_, delta.new_crack_faces);
  list(removed_, delta.removed_surface_vertices);
  list(touched_, delta.touched_surface_vertices);
  for (const auto& [v, from] : new_) delta.new_surface_vertices.push_back(v);
  std::sort(delta.new_surface_vertices.begin(), delta.new_surface_vertices.end());
  for (const SurfaceVertexId v : delta.new_surface_vertices) delta.copied_from.push_back(new_.at(v));
  return delta;
}

}  // namespace geo
