#include "contact/surface_motion.h"

namespace geo {

StandingRows::StandingRows(const SurfaceMotion& motion) : triangles(motion.triangles), joined(motion.triangles.size(), 0) {
  std::vector<std::uint8_t> used(motion.from.size(), 0), stands(motion.from.size(), 0);
  for (std::uint32_t v = 0; v < motion.together.size(); ++v)
    if (motion.together[v] != v) stands[motion.together[v]] = 1;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (auto& v : triangles[t]) v = motion.together[v], used[v] = 1, joined[t] |= stands[v];
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) rows.push_back(v), middle += motion.to[v];
  if (!rows.empty()) middle /= double(rows.size());
}

}  // namespace geo
