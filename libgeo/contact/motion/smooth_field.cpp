#include "contact/motion/smooth_field.h"

#include <algorithm>
#include <cmath>

namespace geo {

template <class Take>
void SmoothField::each(const Take& take) const {
  for (std::size_t x = 0; x < size_[0]; ++x)
    for (std::size_t y = 0; y < size_[1]; ++y)
      for (std::size_t z = 0; z < size_[2]; ++z) take(index(x, y, z), {x, y, z});
}

SmoothField::SmoothField(const std::vector<Vec3>& at, const std::vector<Vec3>& by, std::span<const std::uint32_t> rows,
                         double cell)
    : cell_(cell) {
  Box3 box;
  for (const auto v : rows) box.add(at[v]);
  if (box.empty()) return;
  const double most = 64.0 * double(rows.size()) + 4096;
  for (;; cell_ *= 1.5) {
    double count = 1;
    for (int k = 0; k < 3; ++k) count *= std::floor((box.hi[k] - box.lo[k]) / cell_) + 4;
    if (count <= most) break;
  }
  origin_ = box.lo - Vec3::Constant(cell_);  // a point's three weights on an axis are those about it
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<std::size_t>((box.hi[k] - box.lo[k]) / cell_) + 4;
  value_.assign(size_[0] * size_[1] * size_[2], Vec3::Zero());
  std::vector<double> total(value_.size(), 0);
  for (const auto v : rows) {
    const Weights w = weights(at[v]);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t at_grid = index(w.first[0] + i, w.first[1] + j, w.first[2] + k);
          const double weight = w.w[0][i] * w.w[1][j] * w.w[2][k];
          total[at_grid] += weight, value_[at_grid] += weight * by[v];
        }
  }
  for (std::size_t g = 0; g < value_.size(); ++g)
    if (total[g] > 0) value_[g] /= total[g];
  const std::size_t stride[3] = {size_[1] * size_[2], size_[2], 1};
  // What corners of a triangle do not reach, but its middle may, is as beside it.
  std::vector<std::uint8_t> filled(value_.size());
  for (std::size_t g = 0; g < filled.size(); ++g) filled[g] = total[g] > 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = filled;
    each([&](std::size_t g, const std::size_t(&place)[3]) {
      if (before[g]) return;
      int count = 0;
      Vec3 sum = Vec3::Zero();
      if (place[axis] > 0 && before[g - stride[axis]]) sum += value_[g - stride[axis]], ++count;
      if (place[axis] + 1 < size_[axis] && before[g + stride[axis]]) sum += value_[g + stride[axis]], ++count;
      if (count > 0) value_[g] = sum / count, filled[g] = 1;
    });
  }
  // Derivatives along axes are averages of differences on the grid.
  double first = 0, second = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double steepest = 0;
    each([&](std::size_t g, const std::size_t(&place)[3]) {
      if (place[axis] + 1 < size_[axis] && filled[g] && filled[g + stride[axis]])
        steepest = std::max(steepest, (value_[g] - value_[g + stride[axis]]).squaredNorm());
      for (int other = axis; other < 3; ++other) {
        if (place[axis] + 1 >= size_[axis] || place[other] + 1 >= size_[other]) continue;
        if (axis == other && place[axis] + 2 >= size_[axis]) continue;
        const std::size_t a = g + stride[axis], b = g + stride[other], c = a + stride[other];
        if (filled[g] && filled[a] && filled[b] && filled[c])
          second = std::max(second, (value_[g] - value_[a] - value_[b] + value_[c]).squaredNorm());
      }
    });
    first += steepest;
  }
  double largest = 0;
  for (const Vec3& v : value_) largest = std::max(largest, v.norm());
  slope_ = std::max(std::sqrt(first), largest) /
           cell_;  // points with something unknown between them are more than two cells apart
  bend_ = 3 * std::sqrt(second) / (cell_ * cell_);  // the norm of a matrix is at most three times its largest entry
}

SmoothField::Weights SmoothField::weights(const Vec3& p) const {
  Weights w;
  for (int k = 0; k < 3; ++k) {
    const double t = (p[k] - origin_[k]) / cell_, whole = std::clamp(std::floor(t + 0.5), 1.0, double(size_[k]) - 2);
    const double f = std::clamp(t - whole, -0.5, 0.5);
    w.first[k] = static_cast<std::size_t>(whole) - 1;
    w.w[k][0] = 0.5 * (0.5 - f) * (0.5 - f), w.w[k][1] = 0.75 - f * f, w.w[k][2] = 0.5 * (0.5 + f) * (0.5 + f);
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
