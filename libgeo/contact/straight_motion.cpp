#include "contact/straight_motion.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/dividers.h"
#include "contact/parting.h"

namespace geo {
namespace {

bool any_corner(const Triangle& t, const std::vector<std::uint8_t>& marked) { return marked[t[0]] || marked[t[1]] || marked[t[2]]; }

Box3 swept(const Triangle& t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Box3 box = box_of(from[t[0]], from[t[1]], from[t[2]]);
  for (const auto v : t) box.add(to[v]);
  return box;
}

bool keep_apart(const Triangle& s, const Triangle& t, const std::vector<Vec3>& from, const std::vector<Vec3>& to, double gap) {
  std::pair<Simplex, Simplex> parts[2];
  const int count = parts_apart(s, t, parts);
  for (int k = 0; k < count; ++k) {
    const auto& [a, b] = parts[k];
    const double share = count == 2 ? 0.5 : 1;
    const bool kept = some_direction(a, b, from, to, [&, &a = a, &b = b](const Vec3& n, double before) {
      return before > 0 && parted(n, a, b, to) >= std::min(gap * n.norm(), share * before);
    });
    if (!kept) return false;
  }
  return true;
}

}  // namespace

void move_straight(const std::vector<Triangle>& triangles, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs,
                   const std::vector<Vec3>& to, double gap, std::vector<Vec3>& at) {
  constexpr int most_halvings = 2;
  const std::vector<Vec3> start = at;
  std::vector<double> share(at.size(), 0);
  std::vector<std::uint8_t> moves(at.size(), 0), blocked(at.size(), 0), changed(triangles.size(), 1), meets(pairs.size());
  for (const auto& t : triangles)
    for (const auto v : t) share[v] = to[v] != start[v], moves[v] = share[v] > 0;
  for (int trial = 0;; ++trial) {
    for (std::size_t v = 0; v < at.size(); ++v)
      if (moves[v] || blocked[v]) at[v] = share[v] == 1 ? to[v] : Vec3(start[v] + share[v] * (to[v] - start[v]));
    parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto &s = triangles[pairs[i].first], &t = triangles[pairs[i].second];
        const bool asked = (changed[pairs[i].first] || changed[pairs[i].second]) && (any_corner(s, moves) || any_corner(t, moves));  // those that stay are apart
        meets[i] = asked && swept(s, start, at).grown(gap).meets(swept(t, start, at)) && !keep_apart(s, t, start, at, gap);
      }
    });
    std::fill(blocked.begin(), blocked.end(), 0);
    bool done = true;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (meets[i]) {
        done = false;
        for (const auto& t : {triangles[pairs[i].first], triangles[pairs[i].second]})
          for (const auto v : t) blocked[v] = 1;
      }
    if (done) return;
    for (std::size_t v = 0; v < at.size(); ++v)
      if (blocked[v]) share[v] = trial < most_halvings ? 0.5 * share[v] : 0, moves[v] = share[v] > 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) changed[t] = any_corner(triangles[t], blocked);
  }
}

}  // namespace geo
