#include "contact/motion/straight_motion.h"

#include <algorithm>

#include "contact/detection/separating_axes.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

bool any_corner(const Triangle& t, const std::vector<std::uint8_t>& marked) {
  return marked[t[0]] || marked[t[1]] || marked[t[2]];
}

Box3 swept(const Triangle& t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Box3 box = box_of(from[t[0]], from[t[1]], from[t[2]]);
  for (const auto v : t) box.add(to[v]);
  return box;
}

}  // namespace

void move_straight(const std::vector<Triangle>& triangles,
                   std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Vec3>& to,
                   double gap, std::vector<Vec3>& at) {
  constexpr int most_halvings = 2;
  enum : std::uint8_t { parted, meets, never };  // never: whichever part of their ways the corners go
  const std::vector<Vec3> start = at;
  std::vector<double> share(at.size(), 0);
  std::vector<std::uint8_t> moves(at.size(), 0), blocked(at.size(), 0), changed(triangles.size(), 1),
      asked(triangles.size()), found(pairs.size(), parted);
  for (const auto& t : triangles)
    for (const auto v : t) share[v] = to[v] != start[v], moves[v] = share[v] > 0;
  std::vector<Box3> boxes(triangles.size());
  for (int trial = 0;; ++trial) {
    for (std::size_t v = 0; v < at.size(); ++v)
      if (moves[v] || blocked[v]) at[v] = share[v] == 1 ? to[v] : Vec3(start[v] + share[v] * (to[v] - start[v]));
    parallel_for(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        if (changed[t])
          boxes[t] = swept(triangles[t], start, at).grown(0.5 * gap), asked[t] = any_corner(triangles[t], moves);
    });
    parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
      const auto kept = [gap](const PairSeparation& p, bool adjacent) {
        return p.start > 0 && p.end >= std::min(gap, adjacent ? 0.5 * p.start : p.start);
      };
      const auto for_good = [gap](const PairSeparation& p, bool adjacent) {
        return p.swept > 0 && p.swept >= std::min(gap, adjacent ? 0.5 * p.start : p.start);
      };
      // Numbers: of the pair, and whether it is one of neighbours.
      const auto judge = [&](std::size_t number, const SeparatingAxes& p, std::size_t lane) {
        bool any = false, any_for_good = false;
        for (int k = 0; k < SeparatingAxes::count; ++k) {
          const PairSeparation one{p.start_separation[k][lane], p.end_separation[k][lane], p.swept_separation[k][lane]};
          any |= kept(one, number % 2 != 0), any_for_good |= for_good(one, number % 2 != 0);
        }
        auto& all = found[number / 2];
        if (!any)
          all = meets;
        else if (!any_for_good && all == never)
          all = parted;
      };
      SeparatingAxisBatch<decltype(judge)> couples(start, at, true, judge);
      std::pair<Simplex, Simplex> parts[2];
      for (std::size_t i = begin; i < end; ++i) {
        const auto& [p, q] = pairs[i];
        if (found[i] == never) continue;
        found[i] = parted;
        if (!(changed[p] || changed[q]) || !(asked[p] || asked[q])) continue;  // those that stay are apart
        if (!boxes[p].meets(boxes[q])) continue;
        found[i] = never;
        const int count = disjoint_subsimplices(triangles[p], triangles[q], parts);
        for (int k = 0; k < count; ++k) {
          const PrimitivePair couple{parts[k].first, parts[k].second};
          const PairSeparation across = centroid_separation(couple, start, at);
          if (!kept(across, count == 2))
            couples.add(couple, 2 * i + (count == 2));
          else if (!for_good(across, count == 2) && found[i] == never)
            found[i] = parted;
        }
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
