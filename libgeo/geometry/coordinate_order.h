// An order of points that does not depend on ids.
#pragma once

#include <algorithm>

#include "kerf/vec.h"

namespace geo {

/// Whether p is before q by x, then y, then z.
inline bool is_before(const Vec3& p, const Vec3& q) {
  return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
}

}  // namespace geo
