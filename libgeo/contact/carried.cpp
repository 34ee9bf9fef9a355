#include "contact/carried.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "contact/affine_motion.h"
#include "contact/smooth_field.h"

namespace geo {
namespace {

constexpr double steepest = 0.6;  // below 1, where a motion need not be one-to-one

}  // namespace

Carried::Carried(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> rows, const std::vector<Vec3>& start, const std::vector<Vec3>& to, double edge)
    : triangles_(triangles), rows_(rows), start_(start), field_(start), deviation_(triangles.size()), carried_(start.size(), 0), in_zone_(start.size(), 0), parent_(start.size()) {
  std::iota(parent_.begin(), parent_.end(), 0u);
  std::vector<Vec3> by(start.size(), Vec3::Zero());
  for (const auto v : rows) by[v] = to[v] - start[v];
  const SmoothField field(start, by, rows, 4 * edge);
  share_ = std::min(1.0, steepest / std::max(1e-300, field.slope()));
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) field_[rows[i]] += share_ * field(start[rows[i]]);
  });
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [i, j, k] = triangles[t];
    deviation_[t] = share_ * field.deviation(std::sqrt(std::max({(start[j] - start[i]).squaredNorm(), (start[k] - start[j]).squaredNorm(), (start[i] - start[k]).squaredNorm()})));
  }
}

bool Carried::add(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const std::vector<std::uint8_t> before = carried_;
  bool grown = false;
  for (const auto& [s, t] : pairs) {
    bool all = true;
    for (const auto of : {s, t})
      for (const auto v : triangles_[of]) all &= before[v] != 0;
    for (const auto of : {s, t})
      for (const auto v : triangles_[of]) {
        if (all)
          grown |= join(triangles_[s][0], v);
        else
          grown |= !carried_[v], carried_[v] = 1;
      }
  }
  return grown;
}

bool Carried::add_all() {
  bool grown = false;
  for (const auto v : rows_) grown |= !carried_[v], carried_[v] = 1;
  return grown;
}

void Carried::place(std::vector<Vec3>& next) const {
  for (const auto v : rows_)
    if (carried_[v]) next[v] = field_[v];
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t v = 0; v < in_zone_.size(); ++v)
    if (in_zone_[v]) members[zone(v)].push_back(v);
  for (const auto& [one, rows] : members) move_rigidly(rows, start_, field_, next);
}

bool Carried::keep_apart(std::uint32_t s, std::uint32_t t, double distance) const {
  const auto each = [&](const auto& test) {
    return std::all_of(triangles_[s].begin(), triangles_[s].end(), test) && std::all_of(triangles_[t].begin(), triangles_[t].end(), test);
  };
  if (!each([&](std::uint32_t v) { return carried_[v] != 0; })) return false;
  if (distance > (deviation_[s] + deviation_[t]) / (1 - steepest)) return true;
  const auto first = triangles_[s][0];
  return each([&](std::uint32_t v) { return in_zone_[v] && zone(v) == zone(first); });
}

std::size_t Carried::in_zones() const { return static_cast<std::size_t>(std::count(in_zone_.begin(), in_zone_.end(), 1)); }

std::uint32_t Carried::zone(std::uint32_t v) const {
  while (parent_[v] != v) v = parent_[v];
  return v;
}

bool Carried::join(std::uint32_t v, std::uint32_t w) {
  const bool is_new = !in_zone_[v] || !in_zone_[w] || zone(v) != zone(w);
  in_zone_[v] = in_zone_[w] = 1;
  const auto a = zone(v), b = zone(w), least = std::min(a, b);
  parent_[std::max(a, b)] = parent_[v] = parent_[w] = least;
  return is_new;
}

}  // namespace geo
