#include "contact/motion/rigid_zones.h"

#include <algorithm>
#include <map>

namespace geo {

bool RigidZones::join(const Triangle& s, const Triangle& t) {
  const bool is_new = !have(s, t);
  for (const auto& of : {s, t})
    for (const auto v : of) joined_.unite(s[0], v), in_zone_[v] = 1;
  return is_new;
}

bool RigidZones::have(const Triangle& s, const Triangle& t) const {
  for (const auto& of : {s, t})
    for (const auto v : of)
      if (!in_zone_[v] || joined_.find_shared(v) != joined_.find_shared(s[0])) return false;
  return true;
}

std::size_t RigidZones::size() const {
  return static_cast<std::size_t>(std::count(in_zone_.begin(), in_zone_.end(), 1));
}

std::vector<std::vector<std::uint32_t>> RigidZones::members() const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> of;
  for (std::uint32_t v = 0; v < in_zone_.size(); ++v)
    if (in_zone_[v]) of[joined_.find_shared(v)].push_back(v);
  std::vector<std::vector<std::uint32_t>> all;
  for (auto& [one, rows] : of) all.push_back(std::move(rows));
  return all;
}

}  // namespace geo
