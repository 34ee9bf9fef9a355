// Separating axes certify pairs without a common vertex: n · (a − b) > rounding at both ends of the
// motion. Height-field fans certify pairs at a vertex; the exact test decides what is left.
#include "contact/detection/motion_certifier.h"

#include <algorithm>
#include <utility>

#include "contact/detection/candidate_axes.h"
#include "contact/detection/find_crossings.h"
#include "kerf/parallel.h"

namespace geo {

MotionCertifier::MotionCertifier(const Motion& motion, TrianglePlanes& planes)
    : m_(motion), planes_(planes), certified_fans_(motion.start.size(), 0) {
  planes_.compute(m_.surface.triangles, m_.start, m_.next);
}

std::vector<MotionCertifier::Pair> MotionCertifier::uncertified_pairs(std::span<const Pair> pairs,
                                                                      const std::vector<std::uint8_t>& changed,
                                                                      const KnownDisjoint& known_disjoint) {
  update_planes(changed);
  constexpr std::size_t chunk = 1024;
  std::vector<std::vector<Pair>> found((pairs.size() + chunk - 1) / chunk);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      certify(pairs.subspan(c * chunk, std::min(chunk, pairs.size() - c * chunk)), changed, known_disjoint, found[c]);
  });
  // Pairs with a common vertex need the test at the end alone: they cannot pass through each other
  // without crossing other triangles.
  const auto uncertified_fans = m_.fans.find_uncertified(changed, m_.representative, m_.next, certified_fans_);
  std::vector<Pair> result = crossings_at_vertices(m_.fans, uncertified_fans, certified_fans_, m_.surface.triangles,
                                                   m_.next, m_.two_sided, changed);
  for (const auto& some : found) result.insert(result.end(), some.begin(), some.end());
  std::sort(result.begin(), result.end());
  return result;
}

// Triangle normals and differences of centroids certify most pairs; the others are tried with all
// axes, eight pairs at a time.
void MotionCertifier::certify(std::span<const Pair> pairs, const std::vector<std::uint8_t>& changed,
                              const KnownDisjoint& known_disjoint, std::vector<Pair>& uncertified) const {
  const auto& triangles = m_.surface.triangles;
  const double rounding = m_.rounding;
  const auto test_exactly = [&](const Pair& p) {
    if (triangles_cross(triangles[p.first], triangles[p.second], m_.next, m_.two_sided)) uncertified.push_back(p);
  };
  std::vector<Pair> disjoint;  // pairs without a common representative
  for (const Pair& pair : pairs) {
    if (!changed[pair.first] && !changed[pair.second]) continue;
    if (m_.surface.share_representative(pair.first, pair.second))
      test_exactly(pair);
    else
      disjoint.push_back(pair);
  }
  planes_.remove_separated(disjoint, rounding, rounding);
  planes_.remove_centroid_separated(disjoint, rounding, rounding);
  const auto simplex_pair = [&](const Pair& p) {
    const auto simplex = [&](std::uint32_t t) {
      return Simplex{{triangles[t][0], triangles[t][1], triangles[t][2]}, 3};
    };
    return SimplexPair{simplex(p.first), simplex(p.second)};
  };
  const auto separates = [&](double at_start, double at_end) { return at_start > rounding && at_end > rounding; };
  const auto certify_one = [&](std::size_t i, const CandidateAxes& axes, std::size_t lane) {
    for (int k = 0; k < CandidateAxes::count; ++k)
      if (separates(axes.start_separation[k][lane], axes.end_separation[k][lane])) return;
    if (any_tilted_axis(simplex_pair(disjoint[i]), axes, lane, m_.start, m_.next,
                        [&](const Vec3&, double at_start, double at_end) { return separates(at_start, at_end); }))
      return;
    if (known_disjoint(disjoint[i].first, disjoint[i].second,
                       axes.start_separation[CandidateAxes::between_closest][lane]))
      test_exactly(disjoint[i]);
    else
      uncertified.push_back(disjoint[i]);
  };
  CandidateAxisBatch<decltype(certify_one)> batch(m_.start, m_.next, true, certify_one);
  for (std::size_t i = 0; i < disjoint.size(); ++i) batch.add(simplex_pair(disjoint[i]), i);
  batch.finish();
}

void MotionCertifier::update_planes(const std::vector<std::uint8_t>& changed) {
  if (std::exchange(planes_current_, false)) return;
  parallel_for(changed.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (changed[t]) planes_.update_end(t);
  });
}

}  // namespace geo
