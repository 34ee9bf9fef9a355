// A solid's surface from the points of a scan. The work is done by PCL in a module of its own,
// kerf-scan.so, so that programs which read no scan load neither it nor what it needs.
#pragma once

#include <cstddef>
#include <string>

#include <kerf/files.h>
#include <kerf/mesh.h>

namespace scan {

struct Options {
  double outliers = 3;  ///< deviations above the mean distance of neighbours that leave a point out; 0: none
  int depth = 0;        ///< of the octree, whose finest cells are 2^-depth of its edge; 0: by the spacing of the points
};

/// Figures of a scan and its surface. Lengths are in model units.
struct Stats {
  std::size_t points = 0;    ///< that were used
  std::size_t outliers = 0;  ///< left out
  bool estimated = false;    ///< whether normals were estimated, as the file has none
  int depth = 0;             ///< of the octree
  double spacing = 0;        ///< median distance of a point to its fourth neighbour
  std::size_t holes = 0;     ///< regions without points that were filled
  double hole_share = 0;     ///< their share of the area
  std::size_t blobs = 0;     ///< parts of the surface without points, which were left out
  double median = 0;         ///< distance of the points to the surface
  double upper = 0;          ///< distance that 95 of 100 points do not exceed
};

struct Result {
  geo::TriangleMesh mesh;
  Stats stats;
};

/// The surface of a scan. Outliers are left out, and normals are estimated where there are none. A
/// surface is fitted (Kazhdan and Hoppe 2013), and has the colours of the nearest points.
///
/// Throws InputError for fewer than ten points, or where they make no surface; also where the
/// module or PCL is missing.
Result reconstruct(const geo::PointCloud& cloud, const Options& options);

}  // namespace scan
