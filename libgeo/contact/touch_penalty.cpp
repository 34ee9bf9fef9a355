#include "contact/touch_penalty.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/friction.h"

namespace geo {
namespace {

constexpr std::size_t few = 64;  // rows that a thread is worth

}  // namespace

void TouchPenalty::add(const RelativeRow& row, const Vec3& normal, double depth, double stiffness, const Vec3& start) {
  rows_.push_back({entries_.size(), entries_.size() + row.entries.size(), normal, depth, stiffness, start, Mat3::Zero(), false});
  entries_.insert(entries_.end(), row.entries.begin(), row.entries.end());
}

void TouchPenalty::reserve(std::span<const RelativeRow> rows) {
  std::size_t entries = entries_.size();
  for (const RelativeRow& row : rows) entries += row.entries.size();
  entries_.reserve(entries), rows_.reserve(rows_.size() + rows.size());
}

void TouchPenalty::each_row(const VisitRow& visit) const {
  for (const Row& row : rows_) visit(entries(row), row.curvature);
}

void TouchPenalty::add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sums) const {
  std::vector<double> energy(rows_.size());
  parallel_for(rows_.size(), few, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const Row& row = rows_[r];
      const Vec3 way = at(row, u) - row.start;
      const double along = row.normal.dot(way), depth = std::max(0.0, row.depth - along);
      energy[r] = 0.5 * row.stiffness * depth * depth;
      if (row.depth > 0 && options_.friction > 0) energy[r] += friction_energy(most_friction(row), (way - along * row.normal).norm(), options_.slow);
    }
  });
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (rows_[r].first != rows_[r].end) sums[part[entries_[rows_[r].first].node]] += energy[r];
}

std::size_t TouchPenalty::pressing() const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.pressing; }));
}

void TouchPenalty::force(const std::vector<Vec3>& u, std::vector<Vec3>& out) {
  std::vector<Vec3> force(rows_.size());
  parallel_for(rows_.size(), few, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      Row& row = rows_[r];
      const Vec3& n = row.normal;
      const Vec3 way = at(row, u) - row.start;
      const double along = n.dot(way), depth = std::max(0.0, row.depth - along);
      force[r] = row.stiffness * depth * n;
      row.pressing = depth > 0;
      row.curvature = depth > 0 ? Mat3(row.stiffness * n * n.transpose()) : Mat3(Mat3::Zero());
      if (!(row.depth > 0 && options_.friction > 0)) continue;
      const Vec3 slide = way - along * n;
      const double drag = friction_drag(most_friction(row), slide.norm(), options_.slow);
      force[r] -= drag * slide;
      row.curvature += drag * (Mat3::Identity() - n * n.transpose());
    }
  });
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (!force[r].isZero(0))
      for (const auto& e : entries(rows_[r])) out[e.node] += e.weight * force[r];
}

}  // namespace geo
