// Motions of all points of a set as one.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Puts the given rows of `at` where the rigid motion takes them that is closest to from → to (Kabsch 1976).
void move_rigidly(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                  std::vector<Vec3>& at);
/// The same of the affine motion; a rigid one where that would turn space over or nearly flatten it.
void move_affinely(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                   std::vector<Vec3>& at);

}  // namespace geo
