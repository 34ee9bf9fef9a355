#include "contact/detection/failing_pairs.h"

#include <algorithm>
#include <utility>

#include "contact/detection/parting_lanes.h"
#include "contact/detection/tilted.h"
#include "kerf/crossing.h"
#include "kerf/parallel.h"

namespace geo {

FailingPairs::FailingPairs(const StandingRows& surface, const VertexFans& fans, std::span<const std::uint32_t> together,
                           bool two_sided, const std::vector<Vec3>& start, const std::vector<Vec3>& next,
                           double rounding, TrianglePlanes& planes)
    : surface_(surface),
      triangles_(surface.triangles),
      fans_(fans),
      together_(together),
      two_sided_(two_sided),
      start_(start),
      next_(next),
      rounding_(rounding),
      planes_(planes),
      opens_out_(start.size(), 0) {
  planes_.place(surface.triangles, start, next);
}

std::vector<FailingPairs::Pair> FailingPairs::among(std::span<const Pair> pairs,
                                                    const std::vector<std::uint8_t>& changed,
                                                    const KeptApart& kept_apart) {
  renew_planes(changed);
  constexpr std::size_t stretch = 1024;
  std::vector<std::vector<Pair>> found((pairs.size() + stretch - 1) / stretch);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto test = [&](const Pair& p) {
        if (triangles_cross(triangles_[p.first], triangles_[p.second], next_, two_sided_)) found[f].push_back(p);
      };
      std::vector<Pair> some;
      for (std::size_t i = f * stretch; i < std::min(pairs.size(), (f + 1) * stretch); ++i) {
        const auto& [p, q] = pairs[i];
        if (!changed[p] && !changed[q]) continue;
        if (surface_.touch(p, q))
          test(pairs[i]);
        else
          some.push_back(pairs[i]);
      }
      planes_.keep_unparted(some, rounding_, rounding_);
      planes_.keep_unparted_across(some, rounding_, rounding_);
      const auto couple = [&](const Pair& p) {
        const auto simplex = [&](std::uint32_t t) {
          return Simplex{{triangles_[t][0], triangles_[t][1], triangles_[t][2]}, 3};
        };
        return Couple{simplex(p.first), simplex(p.second)};
      };
      const auto apart = [&](double first, double last) { return first > rounding_ && last > rounding_; };
      const auto judge = [&](std::size_t i, const Partings& p, std::size_t lane) {
        for (int k = 0; k < Partings::count; ++k)
          if (apart(p.first[k][lane], p.last[k][lane])) return;
        if (some_tilted(couple(some[i]), p, lane, start_, next_,
                        [&](const Vec3&, double first, double last) { return apart(first, last); }))
          return;
        if (kept_apart(some[i].first, some[i].second, p.first[Partings::closest][lane]))
          test(some[i]);
        else
          found[f].push_back(some[i]);
      };
      CouplesInLanes<decltype(judge)> couples(start_, next_, true, judge);
      for (std::size_t i = 0; i < some.size(); ++i) couples.add(couple(some[i]), i);
      couples.finish();
    }
  });
  // Neighbours cannot pass without crossing others.
  const auto shut = fans_.find_shut(changed, together_, next_, opens_out_);
  std::vector<Pair> result = crossings_about(fans_, shut, opens_out_, triangles_, next_, two_sided_, changed);
  for (const auto& some : found) result.insert(result.end(), some.begin(), some.end());
  std::sort(result.begin(), result.end());
  return result;
}

void FailingPairs::renew_planes(const std::vector<std::uint8_t>& changed) {
  if (!std::exchange(asked_before_, true)) return;  // they are of what `next` was when they were made
  parallel_for(changed.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (changed[t]) planes_.renew_end(t);
  });
}

}  // namespace geo
