// Replaces the vertices of triangles by their representatives and records which stand for several.
#include "contact/detection/surface_motion.h"

#include "kerf/parallel.h"

namespace geo {

RepresentativeSurface::RepresentativeSurface(const SurfaceMotion& motion)
    : triangles(motion.triangles), has_coincident(motion.triangles.size(), 0) {
  std::vector<std::uint8_t> used(motion.from.size(), 0), represents_several(motion.from.size(), 0);
  for (std::uint32_t v = 0; v < motion.representative.size(); ++v)
    if (motion.representative[v] != v) represents_several[motion.representative[v]] = 1;
  parallel_for(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      for (auto& v : triangles[t]) {
        v = motion.representative[v];
        has_coincident[t] |= represents_several[v];
      }
  });
  for (const Triangle& t : triangles)
    for (const auto v : t) used[v] = 1;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) {
      vertices.push_back(v);
      target_centroid += motion.to[v];
    }
  if (!vertices.empty()) target_centroid /= double(vertices.size());
}

}  // namespace geo
