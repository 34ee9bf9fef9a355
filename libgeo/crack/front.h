// Splitting fronts (§ 5.1): a polyline per time step, in material coordinates; or a crack that is given whole.
#pragma once

#include <string>
#include <vector>

#include "base/vec.h"

namespace geo {

/// One front over time. A closed front joins its last point to its first. A sheet has a single step, and triangles of
/// its points.
struct Front {
  std::string name;
  bool closed = false;
  std::vector<std::vector<Vec3>> steps;  ///< points per time step, each at least two
  std::vector<Triangle> triangles{};     ///< of a sheet: rows of steps[0]; else none

  bool is_sheet() const { return !triangles.empty(); }
};

/// Points of `next` resampled so that they correspond one to one with those of `previous`: by index where the counts
/// agree, else by arc length.
std::vector<Vec3> correspond(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, bool closed);

/// How many substeps keep every front point's motion per substep at or below `limit` (§ 5.1); at least 1.
int substeps(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, double limit);

}  // namespace geo
