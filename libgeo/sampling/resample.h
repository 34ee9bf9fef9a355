// New sample points near fresh cracks (§ 6.4): offset from both sides, thinned to the wanted
// spacing.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A proposed node, and the point of a crack face that it was offset from.
struct OffsetSample {
  Vec3 position, base;
  double spacing = 0;  ///< wanted at `base`
  std::uint32_t face = 0;
  int side = 0;  ///< 1: offset along the face's normal, 0: against it
};

/// Points at half the spacing from both sides of the faces, no two closer than 0.8 spacings.
/// Larger: fewer samples, more even. `spacing_at` gives the spacing wanted at a point of a face,
/// positive, model units. Deterministic: faces in order, random points on each. The caller keeps
/// the samples that lie in material and see their base.
std::vector<OffsetSample> offset_samples(std::span<const std::array<Vec3, 3>> faces,
                                         const std::function<double(const Vec3&)>& spacing_at, std::uint64_t seed);

}  // namespace geo
