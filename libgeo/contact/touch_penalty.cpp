#include "contact/touch_penalty.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/friction.h"

namespace geo {

void TouchPenalty::add(const RelativeRow& row, const Vec3& normal, double depth, double stiffness, const std::vector<Vec3>& u) {
  Row one{entries_.size(), entries_.size() + row.entries.size(), normal, depth, stiffness, Vec3::Zero(), Mat3::Zero(), false};
  entries_.insert(entries_.end(), row.entries.begin(), row.entries.end());
  one.start = at(one, u);
  rows_.push_back(one);
}

void TouchPenalty::couple(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const {
  for (const Row& row : rows_)
    for (std::size_t i = row.first + 1; i < row.end; ++i) pairs.emplace_back(entries_[i - 1].node, entries_[i].node);
}

void TouchPenalty::add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sums) const {
  for (const Row& row : rows_) {
    if (row.first == row.end) continue;
    double& sum = sums[part[entries_[row.first].node]];
    const Vec3 way = at(row, u) - row.start;
    const double along = row.normal.dot(way), depth = std::max(0.0, row.depth - along);
    sum += 0.5 * row.stiffness * depth * depth;
    if (row.depth > 0 && options_.friction > 0) sum += friction_energy(most_friction(row), (way - along * row.normal).norm(), options_.slow);
  }
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
      const double drag = friction_drag(most_friction(row), slide.norm(), options_.slow);
      f -= drag * slide;
      row.curvature += drag * (Mat3::Identity() - n * n.transpose());
    }
    for (std::size_t i = row.first; i < row.end; ++i) out[entries_[i].node] += entries_[i].weight * f;
  }
  gather_by_node(u.size());
}

void TouchPenalty::gather_by_node(std::size_t nodes) {
  active_.clear();
  first_share_.assign(nodes + 1, 0);
  for (std::uint32_t r = 0; r < rows_.size(); ++r) {
    if (rows_[r].curvature.isZero(0)) continue;
    active_.push_back(r);
    for (std::size_t i = rows_[r].first; i < rows_[r].end; ++i) ++first_share_[entries_[i].node + 1];
  }
  for (std::size_t n = 0; n < nodes; ++n) first_share_[n + 1] += first_share_[n];
  shares_.resize(first_share_.back());
  std::vector<std::uint32_t> next(first_share_.begin(), first_share_.end() - 1);
  for (std::uint32_t a = 0; a < active_.size(); ++a)
    for (std::size_t i = rows_[active_[a]].first; i < rows_[active_[a]].end; ++i) shares_[next[entries_[i].node]++] = {a, entries_[i].weight};
}

void TouchPenalty::blocks(std::vector<Mat3>& out) const {
  for (const auto a : active_) {
    const Row& row = rows_[a];
    for (std::size_t i = row.first; i < row.end; ++i) out[entries_[i].node] += entries_[i].weight * entries_[i].weight * row.curvature;
  }
}

void TouchPenalty::multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const {
  std::vector<Vec3> pull(active_.size());
  parallel_for(active_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) pull[a] = rows_[active_[a]].curvature * at(rows_[active_[a]], p);
  });
  parallel_for(p.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Vec3 sum = Vec3::Zero();
      for (auto i = first_share_[n]; i < first_share_[n + 1]; ++i) sum += shares_[i].weight * pull[shares_[i].active];
      out[n] += sum;
    }
  });
}

}  // namespace geo
