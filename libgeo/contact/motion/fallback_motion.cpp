#include "contact/motion/fallback_motion.h"

#include <algorithm>

#include "contact/motion/smooth_field.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr double steepest = 0.6;  // below 1, where a motion need not be one-to-one

}  // namespace

FallbackMotion::FallbackMotion(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> rows,
                               const std::vector<Vec3>& start, const std::vector<Vec3>& to, double edge)
    : triangles_(triangles),
      rows_(rows),
      start_(start),
      field_(start),
      deviation_(triangles.size()),
      carried_(start.size(), 0),
      zones_(start.size()) {
  std::vector<Vec3> by(start.size(), Vec3::Zero());
  for (const auto v : rows) by[v] = to[v] - start[v];
  const SmoothField field(start, by, rows, 4 * edge);
  share_ = std::min(1.0, steepest / std::max(1e-300, field.slope()));
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) field_[rows[i]] += share_ * field(start[rows[i]]);
  });
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [i, j, k] = triangles[t];
    deviation_[t] =
        share_ *
        field.deviation(std::sqrt(std::max({(start[j] - start[i]).squaredNorm(), (start[k] - start[j]).squaredNorm(),
                                            (start[i] - start[k]).squaredNorm()})));
  }
}

bool FallbackMotion::add(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const std::vector<std::uint8_t> before = carried_;
  bool grown = false;
  for (const auto& [s, t] : pairs) {
    bool all = true;
    for (const auto of : {s, t})
      for (const auto v : triangles_[of]) all &= before[v] != 0;
    if (all)
      grown |= zones_.join(triangles_[s], triangles_[t]);
    else
      for (const auto of : {s, t})
        for (const auto v : triangles_[of]) grown |= !carried_[v], carried_[v] = 1;
  }
  return grown;
}

bool FallbackMotion::add_all() {
  bool grown = false;
  for (const auto v : rows_) grown |= !carried_[v], carried_[v] = 1;
  return grown;
}

void FallbackMotion::place(std::vector<Vec3>& next) const {
  for (const auto v : rows_)
    if (carried_[v]) next[v] = field_[v];
  for (const auto& rows : zones_.members()) apply_rigid_fit(rows, start_, field_, next);
}

bool FallbackMotion::keep_apart(std::uint32_t s, std::uint32_t t, double distance) const {
  const auto carried = [&](std::uint32_t v) { return carried_[v] != 0; };
  for (const auto of : {s, t})
    if (!std::all_of(triangles_[of].begin(), triangles_[of].end(), carried)) return false;
  return distance > (deviation_[s] + deviation_[t]) / (1 - steepest) || zones_.have(triangles_[s], triangles_[t]);
}

}  // namespace geo
