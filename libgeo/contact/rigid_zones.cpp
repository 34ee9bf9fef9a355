#include "contact/rigid_zones.h"

#include <algorithm>
#include <map>

namespace geo {

bool RigidZones::join(const Triangle& s, const Triangle& t) {
  bool is_new = false;
  for (const auto& of : {s, t})
    for (const auto v : of) {
      const auto a = zone(s[0]), b = zone(v);
      is_new |= !in_zone_[v] || a != b;
      size_ += !in_zone_[v], in_zone_[v] = 1;
      parent_[std::max(a, b)] = parent_[v] = std::min(a, b);
    }
  return is_new;
}

bool RigidZones::have(const Triangle& s, const Triangle& t) const {
  for (const auto& of : {s, t})
    for (const auto v : of)
      if (!in_zone_[v] || zone(v) != zone(s[0])) return false;
  return true;
}

std::vector<std::vector<std::uint32_t>> RigidZones::members() const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> of;
  for (std::uint32_t v = 0; v < in_zone_.size(); ++v)
    if (in_zone_[v]) of[zone(v)].push_back(v);
  std::vector<std::vector<std::uint32_t>> all;
  for (auto& [one, rows] : of) all.push_back(std::move(rows));
  return all;
}

}  // namespace geo
