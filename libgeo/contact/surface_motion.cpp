#include "contact/surface_motion.h"

namespace geo {

StandingRows::StandingRows(const SurfaceMotion& motion) : triangles(motion.triangles) {
  std::vector<std::uint8_t> used(motion.from.size(), 0);
  for (auto& t : triangles)
    for (auto& v : t) v = motion.together[v], used[v] = 1;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) rows.push_back(v), middle += motion.to[v];
  if (!rows.empty()) middle /= double(rows.size());
}

}  // namespace geo
