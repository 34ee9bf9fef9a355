#include "contact/touch_penalty.h"

#include <algorithm>

namespace geo {

void TouchPenalty::add(const RelativeRow& row, const Vec3& normal, double depth, double stiffness, const std::vector<Vec3>& u) {
  Row one{entries_.size(), entries_.size() + row.entries.size(), normal, depth, stiffness, Vec3::Zero(), Mat3::Zero(), false};
  entries_.insert(entries_.end(), row.entries.begin(), row.entries.end());
  one.start = at(one, u);
  rows_.push_back(one);
}

double TouchPenalty::energy(const std::vector<Vec3>& u) const {
  double sum = 0;
  for (const Row& row : rows_) {
    const Vec3 way = at(row, u) - row.start;
    const double along = row.normal.dot(way), depth = std::max(0.0, row.depth - along);
    sum += 0.5 * row.stiffness * depth * depth;
    if (!(row.depth > 0) || !(options_.friction > 0)) continue;
    const double slid = (way - along * row.normal).norm(), slow = options_.slow;
    sum += options_.friction * row.stiffness * row.depth * (slid < slow ? 0.5 * slid * slid / slow : slid - 0.5 * slow);
  }
  return sum;
}

std::size_t TouchPenalty::pressing() const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.pressing; }));
}

void TouchPenalty::force(const std::vector<Vec3>& u, std::vector<Vec3>& out) {
  for (Row& row : rows_) {
    const Vec3& n = row.normal;
    const Vec3 way = at(row, u) - row.start;
    const double along = n.dot(way), depth = std::max(0.0, row.depth - along);
    Vec3 f = row.stiffness * depth * n;
    row.pressing = depth > 0;
    row.curvature = depth > 0 ? Mat3(row.stiffness * n * n.transpose()) : Mat3(Mat3::Zero());
    if (row.depth > 0 && options_.friction > 0) {
      const Vec3 slide = way - along * n;
      const double drag = options_.friction * row.stiffness * row.depth / std::max(slide.norm(), options_.slow);
      f -= drag * slide;
      row.curvature += drag * (Mat3::Identity() - n * n.transpose());
    }
    for (std::size_t i = row.first; i < row.end; ++i) out[entries_[i].node] += entries_[i].weight * f;
  }
}

void TouchPenalty::blocks(std::vector<Mat3>& out) const {
  for (const Row& row : rows_) {
    if (row.curvature.isZero(0)) continue;
    for (std::size_t i = row.first; i < row.end; ++i) out[entries_[i].node] += entries_[i].weight * entries_[i].weight * row.curvature;
  }
}

void TouchPenalty::multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const {
  for (const Row& row : rows_) {
    if (row.curvature.isZero(0)) continue;
    const Vec3 f = row.curvature * at(row, p);
    for (std::size_t i = row.first; i < row.end; ++i) out[entries_[i].node] += entries_[i].weight * f;
  }
}

}  // namespace geo
