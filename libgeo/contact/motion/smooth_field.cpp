// Grid values v_g = Σ w_g(x) m / Σ w_g(x) over points x with motion m; field(x) = Σ w_g(x) v_g with
// w the tensor product of quadratic B-splines. Differences of v_g bound the derivatives.
#include "contact/motion/smooth_field.h"

#include <algorithm>
#include <cmath>

namespace geo {

// Calls use(index of a grid point, its three indices), z fastest.
template <class Use>
void SmoothField::for_each_grid_point(const Use& use) const {
  for (std::size_t x = 0; x < size_[0]; ++x)
    for (std::size_t y = 0; y < size_[1]; ++y)
      for (std::size_t z = 0; z < size_[2]; ++z) use(index(x, y, z), {x, y, z});
}

SmoothField::SmoothField(const std::vector<Vec3>& at, const std::vector<Vec3>& motion,
                         std::span<const std::uint32_t> points, double cell)
    : cell_(cell) {
  Box3 box;
  for (const auto v : points) box.add(at[v]);
  if (box.empty()) return;
  make_grid(box, points.size());
  std::vector<std::uint8_t> filled = fill(at, motion, points);
  extend(filled);
  bound_derivatives(filled);
}

// A grid that has the splines of all points of the box. Cells grow by a factor of 1.5 until
// the grid has at most 64 points for each given one, plus 4096: this bounds memory.
void SmoothField::make_grid(const Box3& box, std::size_t points) {
  const double largest = 64.0 * double(points) + 4096;
  for (;; cell_ *= 1.5) {
    double count = 1;
    for (int k = 0; k < 3; ++k) count *= std::floor((box.hi[k] - box.lo[k]) / cell_) + 4;
    if (count <= largest) break;
  }
  origin_ = box.lo - Vec3::Constant(cell_);  // one grid point on either side has weight
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<std::size_t>((box.hi[k] - box.lo[k]) / cell_) + 4;
}

// Values as means of motions. Returns per grid point whether a point counts there.
std::vector<std::uint8_t> SmoothField::fill(const std::vector<Vec3>& at, const std::vector<Vec3>& motion,
                                            std::span<const std::uint32_t> points) {
  value_.assign(size_[0] * size_[1] * size_[2], Vec3::Zero());
  std::vector<double> total(value_.size(), 0);
  for (const auto v : points) {
    const Weights w = weights(at[v]);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t g = index(w.first[0] + i, w.first[1] + j, w.first[2] + k);
          const double weight = w.w[0][i] * w.w[1][j] * w.w[2][k];
          total[g] += weight;
          value_[g] += weight * motion[v];
        }
  }
  std::vector<std::uint8_t> filled(value_.size());
  for (std::size_t g = 0; g < value_.size(); ++g)
    if (total[g] > 0) {
      value_[g] /= total[g];
      filled[g] = 1;
    }
  return filled;
}

// Grid points that no corner of a triangle reaches, although its inside may, get the mean of their
// neighbours: along x, then y, then z.
void SmoothField::extend(std::vector<std::uint8_t>& filled) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = filled;
    const std::size_t step = stride(axis);
    for_each_grid_point([&](std::size_t g, const Index& at) {
      if (before[g]) return;
      int count = 0;
      Vec3 sum = Vec3::Zero();
      if (at[axis] > 0 && before[g - step]) {
        sum += value_[g - step];
        ++count;
      }
      if (at[axis] + 1 < size_[axis] && before[g + step]) {
        sum += value_[g + step];
        ++count;
      }
      if (count > 0) {
        value_[g] = sum / count;
        filled[g] = 1;
      }
    });
  }
}

// Derivatives of a spline along axes are weighted means of differences on the grid: |∂_i f| ≤
// max |v_g − v_(g + e_i)| / cell, and second differences likewise.
void SmoothField::bound_derivatives(const std::vector<std::uint8_t>& filled) {
  double first = 0, second = 0;  // squared differences
  for (int axis = 0; axis < 3; ++axis) {
    double largest = 0;
    for_each_grid_point([&](std::size_t g, const Index& at) {
      if (at[axis] + 1 < size_[axis] && filled[g] && filled[g + stride(axis)])
        largest = std::max(largest, (value_[g] - value_[g + stride(axis)]).squaredNorm());
      for (int other = axis; other < 3; ++other) {
        if (at[axis] + 1 >= size_[axis] || at[other] + 1 >= size_[other]) continue;
        if (axis == other && at[axis] + 2 >= size_[axis]) continue;
        const std::size_t a = g + stride(axis), b = g + stride(other), c = a + stride(other);
        if (filled[g] && filled[a] && filled[b] && filled[c])
          second = std::max(second, (value_[g] - value_[a] - value_[b] + value_[c]).squaredNorm());
      }
    });
    first += largest;
  }
  double longest = 0;
  for (const Vec3& v : value_) longest = std::max(longest, v.norm());
  // Points with an unfilled grid point between them are more than two cells apart: their motions
  // differ by at most twice the longest.
  slope_ = std::max(std::sqrt(first), longest) / cell_;
  bend_ = 3 * std::sqrt(second) / (cell_ * cell_);  // a 3 × 3 matrix' norm is at most 3 times its largest entry
}

// Quadratic B-spline at offset f ∈ [−½, ½] from the nearest grid point: ½ (½ − f)², ¾ − f²,
// ½ (½ + f)².
SmoothField::Weights SmoothField::weights(const Vec3& p) const {
  Weights w;
  for (int k = 0; k < 3; ++k) {
    const double t = (p[k] - origin_[k]) / cell_, nearest = std::clamp(std::floor(t + 0.5), 1.0, double(size_[k]) - 2);
    const double f = std::clamp(t - nearest, -0.5, 0.5);
    w.first[k] = static_cast<std::size_t>(nearest) - 1;
    w.w[k][0] = 0.5 * (0.5 - f) * (0.5 - f);
    w.w[k][1] = 0.75 - f * f;
    w.w[k][2] = 0.5 * (0.5 + f) * (0.5 + f);
  }
  return w;
}

Vec3 SmoothField::operator()(const Vec3& p) const {
  Vec3 sum = Vec3::Zero();
  if (value_.empty()) return sum;
  const Weights w = weights(p);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        sum += w.w[0][i] * w.w[1][j] * w.w[2][k] * value_[index(w.first[0] + i, w.first[1] + j, w.first[2] + k)];
  return sum;
}

}  // namespace geo
