// A triangle's vertices without their order, and the order without them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// The vertex ids in ascending order: equal for triangles of the same vertices.
inline std::array<std::uint32_t, 3> face_key(std::array<VertexId, 3> v) {
  std::sort(v.begin(), v.end());
  return {v[0].value, v[1].value, v[2].value};
}

/// The orientation relative to the key: true for an even permutation of it.
inline bool is_even(const std::array<VertexId, 3>& v) { return (v[0] < v[1]) != ((v[0] < v[2]) != (v[1] < v[2])); }

}  // namespace geo
