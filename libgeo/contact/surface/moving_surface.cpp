// Fans and coincidence are computed on first use. New positions reset the coincidence, another
// topology both.
#include "contact/surface/moving_surface.h"

#include "contact/detection/find_crossings.h"
#include "kerf/parallel.h"

namespace geo {

Coincidence::Coincidence(const std::vector<std::uint32_t>& site, const std::vector<Vec3>& positions)
    : representative(coincident_representatives(site, positions)), coincident(representative) {}

std::vector<Vec3> Coincidence::averaged(const std::vector<Vec3>& values) const {
  constexpr std::size_t vertices_per_task = 1024;
  std::vector<Vec3> result(values.size());
  parallel_for(values.size(), vertices_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto group = coincident[representative[v]];
      if (group.size() == 1) {
        result[v] = values[v];
        continue;
      }
      Vec3 sum = Vec3::Zero();
      for (const auto w : group) sum += values[w];
      result[v] = sum / double(group.size());
    }
  });
  return result;
}

const VertexFans& MovingSurface::fans() {
  if (!fans_) fans_.emplace(topology_.triangles, positions_.size());
  return *fans_;
}

const Coincidence& MovingSurface::coincidence() {
  if (!coincidence_) coincidence_.emplace(topology_.site, positions_);
  return *coincidence_;
}

void MovingSurface::replace(ContactSurface topology, std::vector<Vec3> positions) {
  topology_ = std::move(topology);
  positions_ = std::move(positions);
  fans_.reset();
  coincidence_.reset();
}

}  // namespace geo
