// Walls of a fracture pattern (§ 7, prescoring): triangles that share rows wherever walls meet.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// Three directions at right angles, the columns of a matrix; the last one is `axis`, made a unit
/// vector. Throws InputError for an axis without length.
Mat3 frame_along(const Vec3& axis);

/// Extent of a box along each column of `frame`, from the origin.
Box3 box_along(const Box3& box, const Mat3& frame);

/// Adds a convex polygon, given by rows of the walls' vertices in order, as triangles.
void add_wall(TriangleMesh& walls, std::span<const std::uint32_t> corners);

/// The walls of a grid of boxes: between neighbours whose labels differ. `at[k]` are the ascending
/// coordinates along column k of `frame`; `label` numbers the boxes by their row along each.
TriangleMesh grid_walls(const std::array<std::vector<double>, 3>& at, const std::function<int(int, int, int)>& label,
                        const Mat3& frame);

/// Segments of the plane, given by rows of points, raised to walls from `low` to `high` along the
/// last column of `frame`.
TriangleMesh raised_walls(std::span<const Vec2> points, std::span<const std::array<std::uint32_t, 2>> segments,
                          double low, double high, const Mat3& frame);

/// The sheets' parts inside a box, divided where they cross or touch each other. Throws InputError
/// as insert_sheet() does.
TriangleMesh divided_by_each_other(const std::vector<TriangleMesh>& sheets, const Box3& box);

}  // namespace geo
