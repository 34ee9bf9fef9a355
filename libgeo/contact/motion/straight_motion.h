// Straight motion of each vertex to its target, as far as no pair of triangles can meet.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Moves the vertices `at`, of which no two triangles cross, straight towards `to`: all the way, a
/// half or a quarter of it, or not at all, so that one axis separates each pair at both ends.
/// `triangles`: of representatives. `pairs`: of triangles; no others can come together. Pairs keep
/// the separation `gap`, model units, or what they have if that is less; adjacent triangles half of
/// it.
void move_straight(const std::vector<Triangle>& triangles,
                   std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Vec3>& to,
                   double gap, std::vector<Vec3>& at);

}  // namespace geo
