// Splitting fronts (§ 5.1): a polyline per time step, in material coordinates; or a crack that is given whole.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"
#include "kerf/vec.h"

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

// ---- One step of a crack (§ 5.1, 5.2): sweep, meet, split, keep, stitch, all or nothing.

/// A front as the crack complex knows it between two steps. Contacts are carried by id and never found again by
/// geometry: each segment of the front lists the vertices of K that lie on it, in order, its ends included.
struct FrontState {
  struct Point {
    Vec3 position;  ///< material coordinates
    VertexId id;    ///< the vertex of K at this point; invalid while the point is outside the material
  };
  bool closed = false;
  std::int32_t crack = 0;                    ///< the number of the crack that this front leaves behind; ≥ 1
  std::vector<Point> points;                 ///< the front points as given (or as moved by the guard)
  std::vector<std::vector<Point>> segments;  ///< segments[i]: from points[i] to points[i+1], with the contacts between
  std::uint32_t step = 0;                    ///< how many time steps of its file this front has made
  std::string name;
};

struct CrackOptions {
  double snap = 1e-14;  ///< pre-snap of the strip to vertices of K, relative to the extent's diagonal
  double clear =
      1e-6;  ///< new front points a hundredth of this from a face of K, but not on it, move this far off, relative
  double clearance = 0x1p-46;  ///< how far apart a step must leave what does not touch, relative; the later half of the
                               ///< attempts does without
  double jitter = 1e-9;        ///< first displacement of the new front when the guard refuses a step, relative
  int attempts = 12;           ///< how often a refused step is jittered and redone
  std::uint64_t seed = 1;      ///< of the jitter
};

/// Counts and seconds of one step, by phase.
struct CrackWork {
  std::size_t faces_near = 0, triangles_cut = 0, new_crack_faces = 0, attempts = 0, snapped = 0, repairs = 0;
  double near_seconds = 0, meet_seconds = 0, split_seconds = 0, keep_seconds = 0, stitch_seconds = 0, guard_seconds = 0;
  CrackWork& operator+=(const CrackWork& o);
  double seconds() const;
};

/// The front before its first step: no contacts are known yet. Throws InputError for fewer than two points or
/// coordinates that are not finite.
FrontState begin_front(std::span<const Vec3> points, bool closed, std::int32_t crack);

/// Sweeps the front to `next` (as many points as the front has), inserts the strip into K and returns what changed.
/// Crack initiation, branching, merging and termination need no flags: they are what the intersection says. Throws
/// GeometryError when no attempt passes the guard; `complex` and `front` are then unchanged.
CrackDelta advance(Complex& complex, FrontState& front, std::span<const Vec3> next, const CrackOptions& options = {},
                   CrackWork* work = nullptr);

// ---- A crack given as a whole surface, not as the trace of a front.

/// Inserts what of `sheet` lies in the material as one crack, in one step: any triangles, connected or not, crossing
/// themselves or not; patch and site are ignored. Throws InputError for a sheet with rows out of range or coordinates
/// that are not finite, GeometryError when no attempt passes the guard; `complex` is then unchanged.
CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack,
                        const CrackOptions& options = {}, CrackWork* work = nullptr);

}  // namespace geo
