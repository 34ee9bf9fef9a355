// Each vertex of a surface goes straight to where it wants to be, where nothing is in its way.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// Moves rows of `at`, where no two triangles (of rows that stand for others) cross: all the way to `to`, or half or a
/// quarter of it, or not at all, where a pair of triangles would not be parted all along by one direction. `pairs`: of
/// triangles; no others come together. Parts keep `gap`, model units, or what they have if that is less; those of
/// neighbours half of it.
void move_straight(const std::vector<Triangle>& triangles,
                   std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Vec3>& to,
                   double gap, std::vector<Vec3>& at);

}  // namespace geo
