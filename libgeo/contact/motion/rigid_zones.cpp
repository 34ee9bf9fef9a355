// Zones as a union-find over vertices; zones that share a vertex are one.
#include "contact/motion/rigid_zones.h"

#include <algorithm>
#include <map>

namespace geo {

bool RigidZones::merge(const Triangle& s, const Triangle& t) {
  const bool is_new = !contain(s, t);
  for (const auto& triangle : {s, t})
    for (const auto v : triangle) {
      sets_.unite(s[0], v);
      in_zone_[v] = 1;
    }
  return is_new;
}

bool RigidZones::contain(const Triangle& s, const Triangle& t) const {
  for (const auto& triangle : {s, t})
    for (const auto v : triangle)
      if (!in_zone_[v] || sets_.find_shared(v) != sets_.find_shared(s[0])) return false;
  return true;
}

std::size_t RigidZones::vertex_count() const {
  return static_cast<std::size_t>(std::count(in_zone_.begin(), in_zone_.end(), 1));
}

std::vector<std::vector<std::uint32_t>> RigidZones::zones() const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_first;
  for (std::uint32_t v = 0; v < in_zone_.size(); ++v)
    if (in_zone_[v]) by_first[sets_.find_shared(v)].push_back(v);
  std::vector<std::vector<std::uint32_t>> all;
  for (auto& [first, vertices] : by_first) all.push_back(std::move(vertices));
  return all;
}

}  // namespace geo
