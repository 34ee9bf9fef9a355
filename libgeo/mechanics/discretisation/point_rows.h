// Rows of material points: the nodes whose support holds a point and which it sees, straight ahead or round the front
// of a crack, and how much wider supports must be for enough of them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "mechanics/discretisation/bent_paths.h"
#include "mechanics/discretisation/material_points.h"

namespace geo {

/// What supports are times, one after another, where too few nodes are seen.
constexpr std::array support_growth{1.0, 1.2, 1.44, 1.728, 2.0736};

/// Faces that may hide nodes from points, and the fronts that a way may lead round.
struct Obstacles {
  Obstacles() = default;
  Obstacles(const Complex& surface, std::span<const FaceId> ids);
  TriangleBvh faces;
  std::vector<FrontEdge> fronts;
};
/// All that there are.
Obstacles all_obstacles(const Complex& surface);

/// Where a point goes that is meant to be at p. One that a face passes through is on neither of its sides: it steps
/// aside, towards the nearest node.
Vec3 off_faces(const Body& body, const Vec3& p);

/// A row to be made for a point that has its position, and in `reach` how far that is from where it was meant to be.
struct RowJob {
  MaterialPoint* point;
  ShapeRow* row;
};
/// Makes rows, and all of the points but volumes. Points that follow each other should be near each other. `obstacles`:
/// of all faces; null: those that matter are looked for.
void build_rows(const Body& body, std::vector<RowJob> jobs, const Obstacles* obstacles = nullptr);

}  // namespace geo
