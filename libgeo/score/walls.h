// Builds the walls of a fracture pattern (§ 7, prescoring): triangles that share vertices where
// walls meet.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// An orthonormal frame as the columns of a matrix; the last one is `axis`, normalised. Throws
/// InputError for an axis without length.
Mat3 frame_along(const Vec3& axis);

/// The bounding box of `box` in the coordinates of `frame`.
Box3 box_along(const Box3& box, const Mat3& frame);

/// Adds a convex polygon, given by indices of its vertices in order, as triangles.
void add_wall(TriangleMesh& walls, std::span<const std::uint32_t> corners);

/// The walls of a grid of boxes, between neighbours with different labels. `at[k]`: ascending
/// coordinates along column k of `frame`; `label(i, j, k)`: the label of a box.
TriangleMesh grid_walls(const std::array<std::vector<double>, 3>& at, const std::function<int(int, int, int)>& label,
                        const Mat3& frame);

/// Extrudes planar segments, given by indices of points, from `low` to `high` along the last column
/// of `frame`.
TriangleMesh raised_walls(std::span<const Vec2> points, std::span<const std::array<std::uint32_t, 2>> segments,
                          double low, double high, const Mat3& frame);

/// The parts of sheets inside a box, divided where the sheets cross or touch. Throws InputError as
/// insert_sheet() does.
TriangleMesh divided_by_each_other(const std::vector<TriangleMesh>& sheets, const Box3& box);

}  // namespace geo
