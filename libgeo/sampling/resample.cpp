// Dart throwing (Cook 1986) in the order of faces, with an octree that rejects darts too near to an
// accepted sample.
#include "sampling/resample.h"

#include <cmath>

#include "base/random.h"
#include "sampling/node_grid.h"

namespace geo {

std::vector<OffsetSample> offset_samples(std::span<const std::array<Vec3, 3>> faces,
                                         const std::function<double(const Vec3&)>& spacing_at, std::uint64_t seed) {
  std::vector<OffsetSample> samples;
  std::vector<Vec3> positions;
  if (faces.empty()) return samples;
  NodeGrid grid(spacing_at(faces[0][0]));
  std::vector<std::uint32_t> near;
  Random random(seed);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const auto& [a, b, c] = faces[f];
    const Vec3 n = (b - a).cross(c - a);
    const double twice_area = n.norm();
    if (!(twice_area > 0)) continue;
    double finest = spacing_at((a + b + c) / 3);
    for (const Vec3& p : faces[f]) finest = std::min(finest, spacing_at(p));
    // Four darts for each square of the finest spacing, since most are rejected; 65 a face at most.
    const int darts = 1 + static_cast<int>(std::min(64.0, std::ceil(2 * twice_area / (finest * finest))));
    for (int i = 0; i < darts; ++i) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3 base = a + u * (b - a) + v * (c - a);
      const double spacing = spacing_at(base);
      for (int side = 0; side < 2; ++side) {
        const Vec3 p = base + (side ? 0.5 : -0.5) * spacing / twice_area * n;
        near.clear();
        grid.within(positions, p, 0.8 * spacing, near);
        if (!near.empty()) continue;
        positions.push_back(p);
        grid.insert(positions, static_cast<std::uint32_t>(positions.size() - 1));
        samples.push_back({.position = p, .base = base, .spacing = spacing, .face = f, .side = side});
      }
    }
  }
  return samples;
}

}  // namespace geo
