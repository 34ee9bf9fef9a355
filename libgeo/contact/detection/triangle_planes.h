// Culling of triangle pairs that simple axes separate at the start and at the end of a motion.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/vec.h"

namespace geo {

/// The planes of all triangles of a moving surface, laid out for queries about many pairs. Normals
/// are those at the start. Floating point, with an error of about 1e-15 times the coordinates; the
/// same for any instruction set.
class TrianglePlanes {
 public:
  /// Indices of two triangles.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// No planes.
  TrianglePlanes() = default;
  /// As compute().
  TrianglePlanes(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    compute(triangles, from, to);
  }

  /// Computes the planes for the motion of vertices from → to. Reuses the memory of earlier planes.
  /// Keeps references to `triangles` and `to`.
  void compute(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to);

  /// Must be called after a vertex of triangle i has changed in `to`.
  void update_end(std::size_t i);

  /// Whether the plane of triangle i or j separates them by more than `start` at the start and more
  /// than `end` at the end. j is on the same side at both. `start`, `end` ≥ 0, model units.
  bool separates(std::uint32_t i, std::uint32_t j, double start, double end) const;

  /// Removes the pairs for which separates() is true. The others stay in order.
  void remove_separated(std::vector<Pair>& pairs, double start, double end) const;

  /// Removes the pairs that the difference of centroids at the start separates by more than `start`
  /// and `end`. This axis separates triangles that are neighbours on a sheet, which their planes do
  /// not.
  void remove_centroid_separated(std::vector<Pair>& pairs, double start, double end) const;

  /// For each pair, the larger of the separations by the two planes at the end, on the side of the
  /// start. Negative if the motion takes the triangles through each other's planes.
  std::vector<double> end_separations(std::span<const Pair> pairs) const;

  /// One triangle. Corners have four elements an axis; the last repeats the third.
  struct Plane {
    alignas(32) double at[2][3][4];  // corners at the start and at the end
    double normal[3];                // unit; zero if the triangle has no area
    double centroid[3];              // at the start
    // Extremes of normal · corner at the start and at the end. For slivers the two differ even at
    // the start.
    double low[2], high[2];
  };

 private:
  std::span<const Triangle> triangles_;
  const std::vector<Vec3>* to_ = nullptr;
  UninitializedArray<Plane> planes_;
};

}  // namespace geo
