// The sites of an impact: their Voronoi cells are the pieces.
#pragma once

#include <span>
#include <vector>

#include "kerf/impact.h"
#include "kerf/mesh.h"

namespace geo {

/// Points inside a closed mesh, about evenly: on lines along the axes, between the places where
/// these enter and leave.
std::vector<Vec3> inner_points(const TriangleMesh& mesh, std::uint64_t seed);

/// The map in which pieces are as long along the direction of an impact as across it.
Mat3 shortened_along(const Vec3& direction, double elongation);

/// Sites among points, the nearer to the impact the closer to each other. Distances are those after
/// `stretch`.
std::vector<Vec3> impact_sites(std::span<const Vec3> among, int count, const Impact& impact,
                               const ImpactOptions& options, const Mat3& stretch);

/// The number of sites that an energy makes in a volume; below 2 nothing breaks.
int site_count(double volume, const Impact& impact, const ImpactOptions& options);

/// The walls between the cells of sites of different groups, in a box; `group`: one for each site.
TriangleMesh walls_between(std::span<const Vec3> sites, std::span<const int> group, const Box3& box,
                           const Mat3& stretch);

/// The index of the site that is nearest to a point after `stretch`.
std::size_t nearest_site(std::span<const Vec3> sites, const Vec3& point, const Mat3& stretch);

}  // namespace geo
