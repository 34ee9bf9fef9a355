#include "contact/detection/surface_motion.h"

#include "kerf/parallel.h"

namespace geo {

StandingRows::StandingRows(const SurfaceMotion& motion)
    : triangles(motion.triangles), joined(motion.triangles.size(), 0) {
  std::vector<std::uint8_t> used(motion.from.size(), 0), stands(motion.from.size(), 0);
  for (std::uint32_t v = 0; v < motion.together.size(); ++v)
    if (motion.together[v] != v) stands[motion.together[v]] = 1;
  parallel_for(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      for (auto& v : triangles[t]) v = motion.together[v], joined[t] |= stands[v];
  });
  for (const Triangle& t : triangles)
    for (const auto v : t) used[v] = 1;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) rows.push_back(v), middle += motion.to[v];
  if (!rows.empty()) middle /= double(rows.size());
}

}  // namespace geo
