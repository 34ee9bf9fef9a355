#include "contact/failing_pairs.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/crossing.h"
#include "contact/parting_lanes.h"
#include "contact/tilted.h"

namespace geo {

FailingPairs::FailingPairs(const std::vector<Triangle>& triangles, const VertexFans& fans, bool two_sided, const std::vector<Vec3>& start, const std::vector<Vec3>& next,
                           double rounding)
    : triangles_(triangles), fans_(fans), two_sided_(two_sided), start_(start), next_(next), rounding_(rounding), planes_(triangles, start, next), opens_out_(start.size(), 0) {}

std::vector<FailingPairs::Pair> FailingPairs::among(std::span<const Pair> pairs, const std::vector<std::uint8_t>& changed, const Carried* carried) {
  renew(changed);
  constexpr std::size_t stretch = 1024;
  std::vector<std::vector<Pair>> found((pairs.size() + stretch - 1) / stretch);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto test = [&](const Pair& p) {
        if (triangles_cross(triangles_[p.first], triangles_[p.second], next_, two_sided_)) found[f].push_back(p);
      };
      const auto couple = [&](const Pair& p) {
        const auto simplex = [&](std::uint32_t t) { return Simplex{{triangles_[t][0], triangles_[t][1], triangles_[t][2]}, 3}; };
        return Couple{simplex(p.first), simplex(p.second)};
      };
      const auto apart = [&](double first, double last) { return first > rounding_ && last > rounding_; };
      const auto judge = [&](std::size_t i, const Partings& p, std::size_t lane) {
        for (int k = 0; k < Partings::count; ++k)
          if (apart(p.first[k][lane], p.last[k][lane])) return;
        if (some_tilted(couple(pairs[i]), p, lane, start_, next_, [&](const Vec3&, double first, double last) { return apart(first, last); })) return;
        if (carried && carried->keep_apart(pairs[i].first, pairs[i].second, p.first[Partings::closest][lane])) test(pairs[i]);
        else found[f].push_back(pairs[i]);
      };
      CouplesInLanes<decltype(judge)> couples(start_, next_, true, judge);
      for (std::size_t i = f * stretch; i < std::min(pairs.size(), (f + 1) * stretch); ++i) {
        const auto& [p, q] = pairs[i];
        if (!changed[p] && !changed[q]) continue;
        const auto &s = triangles_[p], &t = triangles_[q];
        const auto in_t = [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
        if (in_t(s[0]) || in_t(s[1]) || in_t(s[2])) {
          if (!in_open_fan(p, q)) test(pairs[i]);  // neighbours cannot pass without crossing others
        } else if (!planes_.part(p, q, rounding_, rounding_)) {
          const Couple both = couple(pairs[i]);
          if (const Parting across = part_across(both, start_, next_); !apart(across.first, across.last)) couples.add(both, i);
        }
      }
      couples.finish();
    }
  });
  std::vector<Pair> result;
  for (const auto& some : found) result.insert(result.end(), some.begin(), some.end());
  std::sort(result.begin(), result.end());
  return result;
}

// Whether a vertex of both has a fan that opens out.
bool FailingPairs::in_open_fan(std::uint32_t p, std::uint32_t q) const {
  const auto &s = fans_.triangles()[p], &t = fans_.triangles()[q];
  return std::any_of(s.begin(), s.end(), [&](auto v) { return opens_out_[v] && (v == t[0] || v == t[1] || v == t[2]); });
}

void FailingPairs::renew(const std::vector<std::uint8_t>& changed) {
  std::vector<std::uint8_t> asked(opens_out_.size(), 0);
  for (std::size_t t = 0; t < changed.size(); ++t)
    if (changed[t])
      for (const auto v : fans_.triangles()[t]) asked[v] = 1;
  parallel_for(asked.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (asked[v]) opens_out_[v] = fans_.open_out(static_cast<std::uint32_t>(v), next_);
  });
  parallel_for(changed.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (changed[t]) planes_.renew_end(t);
  });
}

}  // namespace geo
