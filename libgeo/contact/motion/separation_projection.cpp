#include "contact/motion/separation_projection.h"

#include <algorithm>
#include <numeric>

#include "contact/detection/separating_axes.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {

void SeparationProjection::add(std::span<const Pair> pairs, const std::vector<Vec3>& next) {
  const auto choose = [&](std::size_t i, const SeparatingAxes& p, std::size_t lane) {
    Kept& c = couples_[i];
    const bool neighbours = c.a.size < 3 || c.b.size < 3;
    const double share = neighbours ? 0.5 : 1;  // neighbours may become thinner as the body is squeezed
    double most = 0, best = -std::numeric_limits<double>::infinity();
    for (const auto& first : p.start_separation) most = std::max(most, first[lane]);
    const auto offer = [&](const Vec3& n, double first, double last) {
      if (first > 0 && first >= 0.5 * std::min(most, gap_) && last > best)
        best = last, c.normal = n, c.apart = std::min(gap_, share * first);
      return false;
    };
    for (int k = 0; k < SeparatingAxes::count; ++k)
      offer({p.normal[k][0][lane], p.normal[k][1][lane], p.normal[k][2][lane]}, p.start_separation[k][lane],
            p.end_separation[k][lane]);
    if (!neighbours) any_tilted_axis({c.a, c.b}, p, lane, start_, next, offer);
  };
  std::vector<std::size_t> chosen;
  for (const auto& pair : pairs) {
    std::pair<Simplex, Simplex> parts[2];
    const auto count =
        static_cast<std::size_t>(disjoint_subsimplices(triangles_[pair.first], triangles_[pair.second], parts));
    const std::size_t at =
        known_.try_emplace(std::uint64_t(pair.first) << 32 | pair.second, couples_.size()).first->second;
    if (at == couples_.size()) couples_.resize(at + count);
    for (std::size_t k = 0; k < count; ++k) {
      for (Simplex* one : {&parts[k].first, &parts[k].second})
        for (int i = one->size; i < 3; ++i) one->v[i] = one->v[0];
      couples_[at + k] = {parts[k].first, parts[k].second, Vec3::Zero(), 0, pair.first, pair.second};
      chosen.push_back(at + k);
    }
  }
  parallel_for(chosen.size(), 64, [&](std::size_t begin, std::size_t end) {
    SeparatingAxisBatch<decltype(choose)> in_lanes(start_, next, true, choose);
    for (std::size_t i = begin; i < end; ++i) in_lanes.add({couples_[chosen[i]].a, couples_[chosen[i]].b}, chosen[i]);
    in_lanes.finish();
  });
  for (const auto i : chosen)
    if (couples_[i].normal.isZero(0)) bind({{{couples_[i].s, couples_[i].t}}});
}

bool SeparationProjection::bind(std::span<const Pair> pairs) {
  bool is_new = false;
  for (const auto& [s, t] : pairs) is_new |= zones_.merge(triangles_[s], triangles_[t]);
  return is_new;
}

void SeparationProjection::push(std::vector<Vec3>& at) const {
  constexpr int most_sweeps = 30;
  constexpr double spare = 0.1;  // of what they keep
  const auto each_corner = [](const Kept& c, const auto& take) {
    for (int k = 0; k < c.a.size; ++k) take(c.a.v[k]);
    for (int k = 0; k < c.b.size; ++k) take(c.b.v[k]);
  };
  std::vector<std::uint32_t> first(at.size() + 1, 0);
  for (const Kept& c : couples_) each_corner(c, [&](std::uint32_t v) { ++first[v + 1]; });
  for (std::size_t v = 0; v < at.size(); ++v) first[v + 1] += first[v];
  std::vector<std::uint32_t> of(first.back()), end(first.begin(), first.end() - 1);
  for (std::uint32_t i = 0; i < couples_.size(); ++i)
    each_corner(couples_[i], [&](std::uint32_t v) { of[end[v]++] = i; });
  const auto zones = zones_.zones();
  // Only couples are looked at again of which something has moved.
  std::vector<std::uint32_t> asked(couples_.size()), moved;
  std::iota(asked.begin(), asked.end(), 0u);
  std::vector<std::uint8_t> waits(couples_.size(), 0), has_moved(at.size(), 0);
  for (int sweep = 0; sweep < most_sweeps && !asked.empty(); ++sweep) {
    for (const auto i : asked) {
      const Kept& c = couples_[i];
      if (!zones.empty() && bound(c.s, c.t)) continue;
      double of_a[3], of_b[3];
      for (int k = 0; k < 3; ++k) of_a[k] = c.normal.dot(at[c.a.v[k]]), of_b[k] = c.normal.dot(at[c.b.v[k]]);
      const double least = std::min({of_a[0], of_a[1], of_a[2]}), most = std::max({of_b[0], of_b[1], of_b[2]});
      if (least - most >= c.apart) continue;
      const double plane = 0.5 * (least + most), half = 0.5 * (1 + spare) * c.apart;
      const auto move = [&](std::uint32_t v, double lack, double sign) {
        if (!(lack > 0)) return;
        at[v] += sign * lack * c.normal;
        if (!has_moved[v]) has_moved[v] = 1, moved.push_back(v);
      };
      for (int k = 0; k < c.a.size; ++k) move(c.a.v[k], plane + half - of_a[k], 1);
      for (int k = 0; k < c.b.size; ++k) move(c.b.v[k], of_b[k] - plane + half, -1);
    }
    for (const auto& zone : zones) {
      const auto went = [&](std::uint32_t v) { return sweep == 0 || has_moved[v]; };
      if (std::none_of(zone.begin(), zone.end(), went)) continue;
      apply_rigid_fit(zone, start_, at, at);
      for (const auto v : zone)
        if (!has_moved[v]) has_moved[v] = 1, moved.push_back(v);
    }
    for (const auto v : moved) {
      has_moved[v] = 0;
      for (auto j = first[v]; j < first[v + 1]; ++j) waits[of[j]] = 1;
    }
    moved.clear(), asked.resize(waits.size());
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < waits.size(); ++i) asked[count] = i, count += waits[i], waits[i] = 0;
    asked.resize(count);
  }
}

}  // namespace geo
