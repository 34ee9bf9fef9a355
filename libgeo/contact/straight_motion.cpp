#include "contact/straight_motion.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/dividers.h"
#include "contact/parting_lanes.h"

namespace geo {
namespace {

bool any_corner(const Triangle& t, const std::vector<std::uint8_t>& marked) { return marked[t[0]] || marked[t[1]] || marked[t[2]]; }

Box3 swept(const Triangle& t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Box3 box = box_of(from[t[0]], from[t[1]], from[t[2]]);
  for (const auto v : t) box.add(to[v]);
  return box;
}

}  // namespace

void move_straight(const std::vector<Triangle>& triangles, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs,
                   const std::vector<Vec3>& to, double gap, std::vector<Vec3>& at) {
  constexpr int most_halvings = 2;
  enum : std::uint8_t { parted, meets, never };  // never: whichever part of their ways the corners go
  const std::vector<Vec3> start = at;
  std::vector<double> share(at.size(), 0);
  std::vector<std::uint8_t> moves(at.size(), 0), blocked(at.size(), 0), changed(triangles.size(), 1), found(pairs.size(), parted);
  for (const auto& t : triangles)
    for (const auto v : t) share[v] = to[v] != start[v], moves[v] = share[v] > 0;
  for (int trial = 0;; ++trial) {
    for (std::size_t v = 0; v < at.size(); ++v)
      if (moves[v] || blocked[v]) at[v] = share[v] == 1 ? to[v] : Vec3(start[v] + share[v] * (to[v] - start[v]));
    parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
      // Numbers: of the pair, and whether it is one of neighbours.
      const auto judge = [&](std::size_t number, const Partings& p, std::size_t lane) {
        const bool adjacent = number % 2 != 0;
        bool kept = false, for_good = false;
        for (int k = 0; k < Partings::count; ++k) {
          const double enough = std::min(gap, adjacent ? 0.5 * p.first[k][lane] : p.first[k][lane]);
          kept |= p.first[k][lane] > 0 && p.last[k][lane] >= enough;
          for_good |= p.always[k][lane] > 0 && p.always[k][lane] >= enough;
        }
        auto& all = found[number / 2];
        if (!kept) all = meets;
        else if (!for_good && all == never) all = parted;
      };
      CouplesInLanes<decltype(judge)> couples(start, at, true, judge);
      std::pair<Simplex, Simplex> parts[2];
      for (std::size_t i = begin; i < end; ++i) {
        const auto& [p, q] = pairs[i];
        const auto &s = triangles[p], &t = triangles[q];
        if (found[i] == never) continue;
        found[i] = parted;
        if (!(changed[p] || changed[q]) || !(any_corner(s, moves) || any_corner(t, moves))) continue;  // those that stay are apart
        if (!swept(s, start, at).grown(gap).meets(swept(t, start, at))) continue;
        found[i] = never;
        const int count = parts_apart(s, t, parts);
        for (int k = 0; k < count; ++k) couples.add({parts[k].first, parts[k].second}, 2 * i + (count == 2));
      }
      couples.finish();
    });
    std::fill(blocked.begin(), blocked.end(), 0);
    bool done = true;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (found[i] == meets) {
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
