// A smooth vector field that approximates given motions of points: points near each other in space
// move alike, whatever part of a surface they are on.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Quadratic B-splines on a regular grid. The value at a grid point is the weighted mean of the
/// motions of the points about it, with the same splines as weights (particle-in-cell transfer,
/// Harlow 1964). The field is a function of place alone; so in the motion x + s field(x) no two
/// points meet while s · slope() < 1.
class SmoothField {
 public:
  /// The field of points `at` with motions `motion`, of which only those in `points` count. `cell`:
  /// of the grid, model units; enlarged where the grid would have many more points than there are
  /// points.
  SmoothField(const std::vector<Vec3>& at, const std::vector<Vec3>& motion, std::span<const std::uint32_t> points,
              double cell);

  /// The field at p. Away from the given points it is that of the nearest cell.
  Vec3 operator()(const Vec3& p) const;
  /// Upper bound of the norm of the derivative, between the given points.
  double slope() const { return slope_; }
  /// Upper bound of the distance between the image of a triangle under the field and the flat
  /// triangle of the images of its corners. `edge`: its longest edge, model units. Infinite for
  /// edges longer than a cell. The bound is ½ bend R² for linear interpolation within a circle of
  /// radius R, and R ≤ edge / √3 (Jung).
  double deviation(double edge) const {
    return edge <= cell_ ? bend_ * edge * edge / 6 : std::numeric_limits<double>::infinity();
  }

 private:
  // The 3 × 3 × 3 splines about a point: per axis the index of the first, and three weights.
  struct Weights {
    std::size_t first[3];
    double w[3][3];
  };
  using Index = std::size_t[3];

  void make_grid(const Box3& box, std::size_t points);
  std::vector<std::uint8_t> fill(const std::vector<Vec3>& at, const std::vector<Vec3>& motion,
                                 std::span<const std::uint32_t> points);
  void extend(std::vector<std::uint8_t>& filled);
  void bound_derivatives(const std::vector<std::uint8_t>& filled);
  template <class Use>
  void for_each_grid_point(const Use& use) const;
  Weights weights(const Vec3& p) const;
  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const { return (x * size_[1] + y) * size_[2] + z; }
  std::size_t stride(int axis) const { return axis == 0 ? size_[1] * size_[2] : axis == 1 ? size_[2] : 1; }

  Vec3 origin_ = Vec3::Zero();
  double cell_ = 1, slope_ = 0, bend_ = 0;  // bounds of the first and second derivative
  std::size_t size_[3] = {0, 0, 0};
  std::vector<Vec3> value_;  // per grid point
};

}  // namespace geo
