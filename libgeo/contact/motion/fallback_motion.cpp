// Vertices move by s · field(x), s = min(1, 0.6 / slope): a one-to-one map of space. Flat triangles
// deviate from its image by at most deviation(edge); nearer pairs become rigid zones.
#include "contact/motion/fallback_motion.h"

#include <algorithm>

#include "contact/motion/smooth_field.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Largest slope of the scaled field. Below 1, x + field(x) is one-to-one, and the distance of two
// points shrinks at most by the factor 1 − steepest. Larger: more of the motion in one round, less
// distance left.
constexpr double steepest = 0.6;
// Cell of the field's grid, in mean edges: each has several vertices, so that their mean is smooth.
// Must be above 1: deviation() is infinite for edges longer than a cell.
constexpr double cell_in_edges = 4;

double longest_edge(const Triangle& t, const std::vector<Vec3>& at) {
  const auto& [i, j, k] = t;
  return std::sqrt(
      std::max({(at[j] - at[i]).squaredNorm(), (at[k] - at[j]).squaredNorm(), (at[i] - at[k]).squaredNorm()}));
}

}  // namespace

FallbackMotion::FallbackMotion(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> vertices,
                               const std::vector<Vec3>& start, const std::vector<Vec3>& to, double edge)
    : triangles_(triangles),
      vertices_(vertices),
      start_(start),
      end_(start),
      deviation_(triangles.size()),
      follows_(start.size(), 0),
      zones_(start.size()) {
  std::vector<Vec3> motion(start.size(), Vec3::Zero());
  for (const auto v : vertices) motion[v] = to[v] - start[v];
  const SmoothField field(start, motion, vertices, cell_in_edges * edge);
  share_ = std::min(1.0, steepest / std::max(1e-300, field.slope()));
  parallel_for(vertices.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) end_[vertices[i]] += share_ * field(start[vertices[i]]);
  });
  for (std::size_t t = 0; t < triangles.size(); ++t)
    deviation_[t] = share_ * field.deviation(longest_edge(triangles[t], start));
}

bool FallbackMotion::add(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const std::vector<std::uint8_t> before = follows_;
  bool changed = false;
  for (const auto& [s, t] : pairs) {
    bool all = true;
    for (const auto triangle : {s, t})
      for (const auto v : triangles_[triangle]) all &= before[v] != 0;
    if (all)
      changed |= zones_.merge(triangles_[s], triangles_[t]);
    else
      for (const auto triangle : {s, t})
        for (const auto v : triangles_[triangle]) {
          changed |= !follows_[v];
          follows_[v] = 1;
        }
  }
  return changed;
}

bool FallbackMotion::add_all() {
  bool changed = false;
  for (const auto v : vertices_) {
    changed |= !follows_[v];
    follows_[v] = 1;
  }
  return changed;
}

void FallbackMotion::apply(std::vector<Vec3>& next) const {
  for (const auto v : vertices_)
    if (follows_[v]) next[v] = end_[v];
  for (const auto& zone : zones_.zones()) apply_rigid_fit(zone, start_, end_, next);
}

bool FallbackMotion::keeps_apart(std::uint32_t s, std::uint32_t t, double distance) const {
  const auto follows = [&](std::uint32_t v) { return follows_[v] != 0; };
  for (const auto triangle : {s, t})
    if (!std::all_of(triangles_[triangle].begin(), triangles_[triangle].end(), follows)) return false;
  return distance > (deviation_[s] + deviation_[t]) / (1 - steepest) || zones_.contain(triangles_[s], triangles_[t]);
}

}  // namespace geo
