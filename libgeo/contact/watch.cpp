#include "contact/watch.h"

#include <algorithm>
#include <tuple>

#include "base/parallel.h"
#include "contact/affine_motion.h"
#include "contact/parting_lanes.h"
#include "contact/triangle_planes.h"

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
    if (p.first[k][lane] >= 0.5 * std::min(distance, m.gap) && p.last[k][lane] > best) best = p.last[k][lane], taken = k;
  w.normal = along(taken);
  w.gap = std::min(m.gap, p.first[taken][lane]);
  return true;
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs closest_between(const Pairs& pairs, const std::vector<Triangle>& corners, std::span<const std::uint32_t> owner, const TrianglePlanes& planes, std::size_t most) {
  struct Entry {
    std::uint32_t other;  // the higher of the two owners
    std::uint32_t pair;
    double left;
  };
  // By the lower owner first; row 0 is of triangles that have none.
  const auto low = [&](std::size_t i) { return std::size_t(std::min(owner[corners[pairs[i].first][0]], owner[corners[pairs[i].second][0]]) + 1u); };
  std::size_t owners = 1;
  for (const auto o : owner) owners = std::max<std::size_t>(owners, o + 2u);
  std::vector<std::uint32_t> first(owners + 1, 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) ++first[low(i) + 1];
  for (std::size_t o = 0; o < owners; ++o) first[o + 1] += first[o];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1), order(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) order[next[low(i)]++] = i;
  std::vector<std::uint8_t> keep(pairs.size(), 0);
  parallel_for(owners, 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Entry> some;
    for (std::size_t o = begin; o < end; ++o) {
      if (first[o + 1] - first[o] <= most) {
        for (auto k = first[o]; k < first[o + 1]; ++k) keep[order[k]] = 1;
        continue;
      }
      some.clear();
      for (auto k = first[o]; k < first[o + 1]; ++k) {
        const auto& [s, t] = pairs[order[k]];
        some.push_back({std::max(owner[corners[s][0]], owner[corners[t][0]]), order[k], planes.left(s, t)});
      }
      std::sort(some.begin(), some.end(), [](const Entry& p, const Entry& q) { return std::tie(p.other, p.left, p.pair) < std::tie(q.other, q.left, q.pair); });
      for (std::size_t i = 0, same = 0; i < some.size(); ++i) {
        if (some[i].other != some[same].other) same = i;
        keep[some[i].pair] = i - same < most;
      }
    }
  });
  Pairs result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (keep[i]) result.push_back(pairs[i]);
  return result;
}

}  // namespace

std::vector<Watched> watch(const SurfaceMotion& m, NearPairs& known, std::span<const std::uint32_t> owner, std::size_t most) {
  // All boxes in a frame that moves as the surface does on the whole.
  const StandingRows surface(m);
  const auto& corners = surface.triangles;
  std::vector<Vec3> carried = m.from;
  if (!surface.rows.empty()) move_affinely(surface.rows, m.from, m.to, carried);
  // What is held stays, though the motion does not know of it.
  Vec3 middle = Vec3::Zero();
  for (const auto v : surface.rows) middle += m.from[v] / double(surface.rows.size());
  known.cover(corners.size(), [&](std::size_t t) {
    Box3 box = surface.swept(t, carried, m.to);
    for (const auto v : corners[t]) box.add(m.from[v] - middle);
    return box.grown(0.5 * m.reach);
  }, 0);
  const TrianglePlanes planes(corners, m.from, m.to);
  constexpr std::size_t stretch = 1024;
  std::vector<Pairs> some((known.pairs().size() + stretch - 1) / stretch);
  parallel_for(some.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t i = k * stretch; i < std::min(known.pairs().size(), (k + 1) * stretch); ++i) {
        const auto& [p, q] = known.pairs()[i];
        const auto &s = corners[p], &t = corners[q];
        const auto in_t = [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
        if (!in_t(s[0]) && !in_t(s[1]) && !in_t(s[2]) && !planes.part(p, q, m.gap, m.reach)) some[k].push_back({p, q});
      }
  });
  Pairs pairs;
  for (const auto& s : some) pairs.insert(pairs.end(), s.begin(), s.end());
  if (!owner.empty()) pairs = closest_between(pairs, corners, owner, planes, most);
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
