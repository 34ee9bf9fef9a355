#include "contact/birth/untangle.h"

#include <algorithm>
#include <set>

#include "contact/detection/dividers.h"
#include "kerf/crossing.h"

namespace geo {
namespace {

struct Tangle {
  Simplex a, b;
  Vec3 normal;   // from b to a
  double apart;  // that they are to be
};

// True when that moved one.
bool push(const Tangle& t, std::vector<Vec3>& at, std::vector<std::uint8_t>& moved) {
  if (parted(t.normal, t.a, t.b, at) >= t.apart) return false;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int k = 0; k < t.a.size; ++k) least = std::min(least, t.normal.dot(at[t.a.v[k]]));
  for (int k = 0; k < t.b.size; ++k) most = std::max(most, t.normal.dot(at[t.b.v[k]]));
  const double plane = 0.5 * (least + most), half = 0.55 * t.apart;
  const auto shift = [&](std::uint32_t v, double lack, double sign) {
    if (lack > 0) at[v] += sign * lack * t.normal, moved[v] = 1;
  };
  for (int k = 0; k < t.a.size; ++k) shift(t.a.v[k], plane + half - t.normal.dot(at[t.a.v[k]]), 1);
  for (int k = 0; k < t.b.size; ++k) shift(t.b.v[k], t.normal.dot(at[t.b.v[k]]) - plane + half, -1);
  return true;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> untangle(const ContactSurface& surface,
                                                              const std::function<Vec3(std::uint32_t)>& rest,
                                                              const std::function<Mat3(std::uint32_t)>& slope,
                                                              const std::vector<std::uint8_t>& fresh, double gap,
                                                              std::vector<Vec3>& positions,
                                                              std::vector<std::uint8_t>& marked) {
  constexpr int most_rounds = 16, most_sweeps = 4;
  const auto together = vertices_together(surface.site, positions);
  const auto standing = [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    return Triangle{together[a], together[b], together[c]};
  };
  std::vector<Vec3> start;  // where vertices were, once some are to be pushed
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  std::size_t fewest = ~std::size_t(0);
  std::vector<Tangle> tangles;
  std::vector<std::uint8_t> moved;
  for (int round = 0;; ++round) {
    const auto crossings = find_crossings(surface.triangles, positions, together, true, &marked);
    // In vain, too, when half of the rounds have not helped.
    fewest = std::min(fewest, crossings.size());
    if (crossings.empty() || round == most_rounds || (round >= most_rounds / 2 && crossings.size() > fewest))
      return crossings;
    if (start.empty()) start = positions, moved.assign(positions.size(), 0);
    for (const auto& pair : crossings) {
      if (!known.insert(pair).second) continue;
      std::pair<Simplex, Simplex> parts[2];
      const int count = parts_apart(standing(pair.first), standing(pair.second), parts);
      for (int i = 0; i < count; ++i) {
        const auto& [a, b] = parts[i];
        const bool there = !fresh[pair.first] && !fresh[pair.second];
        const auto from = [&](std::uint32_t v) { return there ? start[v] : rest(v); };
        Vec3 p[3], q[3];
        for (int k = 0; k < a.size; ++k) p[k] = from(a.v[k]);
        for (int k = 0; k < b.size; ++k) q[k] = from(b.v[k]);
        const Vec3 apart = closest_places(p, a.size, q, b.size).apart;
        Vec3 normal = apart;
        if (!there) {
          Mat3 mean = Mat3::Zero();
          for (const Simplex& s : {a, b})
            for (int k = 0; k < s.size; ++k) mean += slope(s.v[k]) / (a.size + b.size);
          normal = mean.inverse().transpose() * apart;
        }
        if (normal.norm() > 0 && normal.allFinite())
          tangles.push_back({a, b, normal.normalized(), std::min(gap, 0.25 * apart.norm())});
      }
    }
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      bool pushed = false;
      for (const Tangle& t : tangles) pushed |= push(t, positions, moved);
      if (!pushed) break;
    }
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = positions[together[v]];
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const Triangle corners = standing(t);
      if (std::any_of(corners.begin(), corners.end(), [&](auto v) { return moved[v]; })) marked[t] = 1;
    }
  }
}

}  // namespace geo
