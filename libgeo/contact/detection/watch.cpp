#include "contact/detection/watch.h"

#include <algorithm>
#include <tuple>

#include "contact/detection/parting_lanes.h"
#include "contact/detection/triangle_planes.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// True when the pair is to be watched.
bool examine(const SurfaceMotion& m, const Partings& p, std::size_t lane, Watched& w) {
  for (int k = 0; k < Partings::closest; ++k)
    if (p.first[k][lane] >= m.gap && p.last[k][lane] >= m.reach) return false;
  const auto along = [&](int k) { return Vec3(p.normal[k][0][lane], p.normal[k][1][lane], p.normal[k][2][lane]); };
  const double distance = p.first[Partings::closest][lane];
  if (!(distance > 0)) return false;
  int taken = Partings::closest;
  double best = p.last[taken][lane];
  if (distance >= m.gap && best >= m.reach) return false;
  for (int k = 0; k < 3; ++k) w.closest.from[k] = p.from[k][lane], w.closest.to[k] = p.to[k][lane];
  w.closest.apart = distance * along(Partings::closest);
  // Another direction, if it parts them about as well at the beginning and better at the end.
  for (int k = 0; k < Partings::closest; ++k)
    if (p.first[k][lane] >= 0.5 * std::min(distance, m.gap) && p.last[k][lane] > best)
      best = p.last[k][lane], taken = k;
  w.normal = along(taken);
  w.gap = std::min(m.gap, p.first[taken][lane]);
  return true;
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// What of a pair decides whether others between the same owners are closer.
struct Between {
  std::uint32_t low, high;  // the two owners
  double left;              // TrianglePlanes::left()
};

Pairs closest_between(const Pairs& pairs, const std::vector<Between>& between, std::span<const std::uint32_t> owner,
                      std::size_t most) {
  struct Entry {
    double left;
    std::pair<std::uint32_t, std::uint32_t> triangles;
    std::uint32_t pair;
    bool operator<(const Entry& o) const {
      return std::tie(left, triangles) < std::tie(o.left, o.triangles);
    }  // whatever order pairs are in
  };
  struct Closest {
    std::uint32_t other;     // the higher of the two owners
    std::vector<Entry> few;  // the closest, ascending
  };
  // By the lower owner first; row 0 is of triangles that have none.
  std::size_t owners = 1;
  for (const auto o : owner) owners = std::max<std::size_t>(owners, o + 2u);
  std::vector<std::uint32_t> first(owners + 1, 0);
  for (const Between& b : between) ++first[b.low + 1u + 1];
  for (std::size_t o = 0; o < owners; ++o) first[o + 1] += first[o];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1), order(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) order[next[between[i].low + 1u]++] = i;
  std::vector<std::uint8_t> keep(pairs.size(), 0);
  parallel_for(owners, 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Closest> closest;
    for (std::size_t o = begin; o < end; ++o) {
      if (first[o + 1] - first[o] <= most) {
        for (auto k = first[o]; k < first[o + 1]; ++k) keep[order[k]] = 1;
        continue;
      }
      std::size_t others = 0;
      for (auto k = first[o]; k < first[o + 1]; ++k) {
        const Between& b = between[order[k]];
        const Entry entry{b.left, pairs[order[k]], order[k]};
        std::size_t c = 0;
        while (c < others && closest[c].other != b.high) ++c;
        if (c == others) {
          if (++others > closest.size()) closest.emplace_back();
          closest[c].other = b.high, closest[c].few.clear();
        }
        auto& few = closest[c].few;
        if (few.size() == most && !(entry < few.back())) continue;
        if (few.size() == most) few.pop_back();
        few.insert(std::upper_bound(few.begin(), few.end(), entry), entry);
      }
      for (std::size_t c = 0; c < others; ++c)
        for (const Entry& e : closest[c].few) keep[e.pair] = 1;
    }
  });
  Pairs result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (keep[i]) result.push_back(pairs[i]);
  return result;
}

}  // namespace

std::vector<Watched> watch(const SurfaceMotion& m, NearPairs& known, std::span<const std::uint32_t> owner,
                           std::size_t most) {
  // All boxes in a frame that moves as the surface does on the whole.
  const StandingRows surface(m);
  const auto& corners = surface.triangles;
  std::vector<Vec3> carried = m.from;
  if (!surface.rows.empty()) apply_affine_fit(surface.rows, m.from, m.to, carried);
  // What is held stays, though the motion does not know of it.
  Vec3 middle = Vec3::Zero();
  for (const auto v : surface.rows) middle += m.from[v] / double(surface.rows.size());
  known.cover(
      m.triangles,
      [&](std::size_t t) {
        Box3 box = surface.swept(t, carried, m.to);
        for (const auto v : corners[t]) box.add(m.from[v] - middle);
        return box.grown(0.5 * m.reach);
      },
      0);
  TrianglePlanes& planes = known.planes();
  planes.place(corners, m.from, m.to);
  constexpr std::size_t stretch = 1024;
  constexpr double sure = 1 + 1e-9;  // so that examine() would say the same
  std::vector<Pairs> some((known.pairs().size() + stretch - 1) / stretch);
  std::vector<std::vector<Between>> some_between(some.size());
  parallel_for(some.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      for (std::size_t i = k * stretch; i < std::min(known.pairs().size(), (k + 1) * stretch); ++i)
        if (const auto& [s, t] = known.pairs()[i]; !surface.touch(s, t)) some[k].push_back({s, t});
      planes.keep_unparted(some[k], m.gap, m.reach);
      planes.keep_unparted_across(some[k], sure * m.gap, sure * m.reach);
      if (owner.empty()) continue;
      const std::vector<double> left = planes.left(some[k]);
      for (std::size_t i = 0; i < some[k].size(); ++i) {
        const auto [low, high] = std::minmax(owner[corners[some[k][i].first][0]], owner[corners[some[k][i].second][0]]);
        some_between[k].push_back({low, high, left[i]});
      }
    }
  });
  Pairs pairs;
  std::vector<Between> between;
  for (const auto& s : some) pairs.insert(pairs.end(), s.begin(), s.end());
  for (const auto& s : some_between) between.insert(between.end(), s.begin(), s.end());
  if (!owner.empty()) pairs = closest_between(pairs, between, owner, most);
  constexpr std::size_t in_lanes = 256;
  std::vector<std::vector<Watched>> found((pairs.size() + in_lanes - 1) / in_lanes);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto couple = [&](std::size_t i) {
        const auto &a = corners[pairs[i].first], &b = corners[pairs[i].second];
        return Couple{{{a[0], a[1], a[2]}, 3}, {{b[0], b[1], b[2]}, 3}};
      };
      const auto judge = [&](std::size_t i, const Partings& p, std::size_t lane) {
        const Couple c = couple(i);
        Watched w{c.a, c.b, Vec3::Zero(), {}, 0};
        if (examine(m, p, lane, w)) found[s].push_back(w);
      };
      CouplesInLanes<decltype(judge)> couples(m.from, m.to, false, judge);
      for (std::size_t i = s * in_lanes; i < std::min(pairs.size(), (s + 1) * in_lanes); ++i) couples.add(couple(i), i);
      couples.finish();
    }
  });
  std::vector<Watched> result;
  for (const auto& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

}  // namespace geo
