// Lengths of edges (§ 6.4) as integers: sums are exact, so a distance does not depend on the order
// of summation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kerf/graph.h"
#include "kerf/nodes.h"
#include "kerf/vec.h"

namespace geo {

/// Upper bound of all lengths.
constexpr std::uint32_t longest_length = 1u << 30;

/// Warped length of an edge, |x_i − x_j| / max(r_i, r_j), in 2⁻²⁴ support radii, rounded up, at
/// least 1.
inline std::uint32_t warped_length(const Vec3& xi, const Vec3& xj, double ri, double rj) {
  const double d = std::sqrt(squared_distance(xi, xj)) / std::max(ri, rj) * double(unit_radius);
  return static_cast<std::uint32_t>(std::clamp(std::ceil(d), 1.0, double(longest_length)));
}
/// The same for nodes i and j.
inline std::uint32_t warped_length(const NodeSet& nodes, std::size_t i, std::size_t j) {
  return warped_length(nodes.position[i], nodes.position[j], nodes.radius[i], nodes.radius[j]);
}

/// Plain length of an edge, |x_i − x_j|, in multiples of `unit`, rounded up, at least 1.
inline std::uint32_t plain_length(const Vec3& xi, const Vec3& xj, double unit) {
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(std::sqrt(squared_distance(xi, xj)) / unit), 1.0, double(longest_length)));
}

/// The unit of plain lengths for a node set: a power of two, about 2⁻²⁶ of the largest support
/// radius.
double plain_unit_for(const NodeSet& nodes);

}  // namespace geo
