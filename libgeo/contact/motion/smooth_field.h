// A smooth field that follows what points want on the average: what is near in space moves alike, whatever it belongs
// to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Quadratic B-splines on a regular grid; the value at a grid point is the average of the points about it, by the same
/// weights (the particle-in-cell transfer of Harlow 1964). Being a function of place alone, the motion x + s field(x)
/// lets no two points meet while s · slope() < 1.
class SmoothField {
 public:
  /// The field of the given rows of `at`, which want to move by `by`. `cell`: model units; made larger where the grid
  /// would have many more points than there are rows.
  SmoothField(const std::vector<Vec3>& at, const std::vector<Vec3>& by, std::span<const std::uint32_t> rows,
              double cell);

  /// At a place that was among those given; elsewhere of what is near.
  Vec3 operator()(const Vec3& p) const;
  /// No smaller than the norm of its derivative anywhere between the points.
  double slope() const { return slope_; }
  /// How far a triangle of the given longest edge is at most from where the field would have its inside, when it moves
  /// its corners.
  double deviation(double edge) const {
    return edge <= cell_ ? bend_ * edge * edge / 6 : std::numeric_limits<double>::infinity();
  }

 private:
  struct Weights {
    std::size_t first[3];
    double w[3][3];
  };
  template <class Take>
  void each(const Take& take) const;
  Weights weights(const Vec3& p) const;
  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const { return (x * size_[1] + y) * size_[2] + z; }

  Vec3 origin_ = Vec3::Zero();
  double cell_ = 1, slope_ = 0, bend_ = 0;
  std::size_t size_[3] = {0, 0, 0};
  std::vector<Vec3> value_;
};

}  // namespace geo
