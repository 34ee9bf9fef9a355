// New sample points near fresh cracks (§ 6.4): offset from both sides, thinned to the wanted spacing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace geo {

/// A proposed node and the point of the crack, with the row of its face, that it was offset from.
struct OffsetSample {
  Vec3 position, base;
  std::uint32_t face = 0;
  int side = 0;  ///< 1: offset along the face's normal, 0: against it
};

/// Points at half the spacing from both sides of the faces, no two closer than 0.8 spacing to each other. Deterministic:
/// faces in order, points on each by a low-discrepancy sequence from the seed. The caller keeps those that lie in
/// material and see their base.
std::vector<OffsetSample> offset_samples(std::span<const std::array<Vec3, 3>> faces, double spacing, std::uint64_t seed);

}  // namespace geo
