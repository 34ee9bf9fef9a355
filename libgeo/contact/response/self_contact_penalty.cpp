#include "contact/response/self_contact_penalty.h"

#include <algorithm>

#include "mechanics/terms/contact_law.h"

namespace geo {
void SelfContactPenalty::add(const RelativeStencil& row, const Vec3& normal, double depth, double stiffness,
                             const Vec3& start) {
  rows_.push_back({entries_.size(), entries_.size() + row.entries.size(), normal, depth, stiffness,
                   std::max(0.0, -depth) / weight_norm(row.entries), start, false});
  entries_.insert(entries_.end(), row.entries.begin(), row.entries.end());
}

void SelfContactPenalty::reserve(std::span<const RelativeStencil> rows) {
  std::size_t entries = entries_.size();
  for (const RelativeStencil& row : rows) entries += row.entries.size();
  entries_.reserve(entries), rows_.reserve(rows_.size() + rows.size());
}

double SelfContactPenalty::energy(std::size_t r, const Vec3& way) const {
  const Row& row = rows_[r];
  const Vec3 gone = way - row.start;
  const double along = row.normal.dot(gone), depth = std::max(0.0, row.depth - along);
  const double normal = 0.5 * row.stiffness * depth * depth;
  return row.depth > 0 && options_.friction > 0
             ? normal + friction_energy(most_friction(row), (gone - along * row.normal).norm(), options_.slow)
             : normal;
}

Potential::Derivatives SelfContactPenalty::derivatives(std::size_t r, const Vec3& way) {
  Row& row = rows_[r];
  const Vec3& n = row.normal;
  const Vec3 gone = way - row.start;
  const double along = n.dot(gone), depth = std::max(0.0, row.depth - along);
  Derivatives result;
  row.pressing = depth > 0;
  if (row.pressing) result.force = row.stiffness * depth * n, result.hessian = row.stiffness * n * n.transpose();
  if (row.depth > 0 && options_.friction > 0) {
    const Vec3 slide = gone - along * n;
    const double drag = friction_drag(most_friction(row), slide.norm(), options_.slow);
    result.force -= drag * slide, result.hessian += drag * (Mat3::Identity() - n * n.transpose());
  }
  return result;
}

std::size_t SelfContactPenalty::pressing() const {
  return static_cast<std::size_t>(
      std::count_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.pressing; }));
}

}  // namespace geo
