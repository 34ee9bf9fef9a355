// Fracture patterns (§ 7): walls that part space into about so many cells.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

enum class Pattern { planes, crossing, voronoi, radial, glass, wood, bricks, curves, sheets };
inline constexpr std::array pattern_names{"planes", "crossing", "voronoi", "radial", "glass",
                                          "wood",   "bricks",   "curves",  "sheets"};

/// The pattern of this name. Throws InputError, which lists the names, when there is none.
Pattern pattern_named(std::string_view name);

struct PatternOptions {
  Pattern pattern = Pattern::voronoi;
  /// planes: what they are across; wood: the grain; bricks: what courses are stacked along; radial, glass: the axis;
  /// curves: what they are swept along. Not given: z for curves, the model's shortest extent for radial and glass, its
  /// longest else.
  std::optional<Vec3> axis;
  std::optional<Vec3> impact;  ///< radial, glass: where cracks meet; voronoi, wood: where cells are small. Not given:
                               ///< the model's middle, no such place
  double cluster = 0.15;       ///< how far from the impact cells are small, as a fraction of the diagonal
  double grain = 5;            ///< wood: how many times longer than thick its cells are
  std::vector<TriangleMesh> sheets;       ///< of the pattern sheets
  std::vector<std::vector<Vec3>> curves;  ///< of the pattern curves: polylines
  std::uint64_t seed = 1;
};

/// Walls of the pattern in a box that holds the model and half as much again. `cells` says how fine: about so many
/// cells hold part of the model (sheets and curves: as given). Throws InputError for options that make no walls.
TriangleMesh pattern_walls(const TriangleBvh& skin, int cells, const PatternOptions& options);

/// Points inside the skin, each as far from those before it as ten tries find (Mitchell 1991), nearer to each other by
/// the impact where there is one. Distances are measured after `stretch`; so are the points returned. The first n of
/// more points are the same.
std::vector<Vec3> spread_sites(const TriangleBvh& skin, int count, const Mat3& stretch, const PatternOptions& options);

}  // namespace geo
