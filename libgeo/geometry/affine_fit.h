// Least-squares fits of one motion to the motions of many points.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// The linear map A that minimises Σ |y − A x|², from cross = Σ y xᵀ and own = Σ x xᵀ, both about
/// the centroids. `regularisation`, a share of the trace of `own`, is added to its diagonal.
Mat3 linear_fit(const Mat3& cross, const Mat3& own, double regularisation = 0);

/// Fits a rigid motion to the motion from → to of the points with the given indices (Kabsch 1976)
/// and writes the images of `from` under it to `at`. `at` may be `from` or `to`. Points have equal
/// weights. The result does not depend on the number of threads.
void apply_rigid_fit(const std::vector<std::uint32_t>& indices, const std::vector<Vec3>& from,
                     const std::vector<Vec3>& to, std::vector<Vec3>& at);

/// As apply_rigid_fit(), with an affine motion. Falls back to the rigid fit if the affine map
/// inverts space or nearly flattens it, or if the points lie in a plane.
void apply_affine_fit(const std::vector<std::uint32_t>& indices, const std::vector<Vec3>& from,
                      const std::vector<Vec3>& to, std::vector<Vec3>& at);

}  // namespace geo
