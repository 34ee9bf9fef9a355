// Culling in three stages: swept boxes in the frame of the surface's affine motion, cheap axes
// (triangle normals, difference of centroids), then all axes of candidate_axes.h.
#include "contact/detection/contact_candidates.h"

#include <algorithm>
#include <tuple>

#include "contact/detection/candidate_axes.h"
#include "contact/detection/triangle_planes.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pairs = std::vector<BroadPhase::Pair>;

// Sets normal, closest points and gap from the axes of the pair. Returns false if the pair is no
// candidate: an axis has start separation ≥ gap and end separation ≥ reach, or the start distance
// is not positive.
bool set_candidate(const SurfaceMotion& m, const CandidateAxes& axes, std::size_t lane, ContactCandidate& candidate) {
  for (int k = 0; k < CandidateAxes::between_closest; ++k)
    if (axes.start_separation[k][lane] >= m.gap && axes.end_separation[k][lane] >= m.reach) return false;
  const auto normal = [&](int k) {
    return Vec3(axes.normal[k][0][lane], axes.normal[k][1][lane], axes.normal[k][2][lane]);
  };
  const double distance = axes.start_separation[CandidateAxes::between_closest][lane];
  if (!(distance > 0)) return false;
  int chosen = CandidateAxes::between_closest;
  double best = axes.end_separation[chosen][lane];
  if (distance >= m.gap && best >= m.reach) return false;
  for (int k = 0; k < 3; ++k) {
    candidate.closest.weights_a[k] = axes.weights_a[k][lane];
    candidate.closest.weights_b[k] = axes.weights_b[k][lane];
  }
  candidate.closest.difference = distance * normal(CandidateAxes::between_closest);
  // Prefer the axis of largest end separation among axes with start separation ≥ min(d, gap) / 2,
  // where d is the distance. A factor above 1/2 leaves fewer axes to choose from.
  for (int k = 0; k < CandidateAxes::between_closest; ++k)
    if (axes.start_separation[k][lane] >= 0.5 * std::min(distance, m.gap) && axes.end_separation[k][lane] > best) {
      best = axes.end_separation[k][lane];
      chosen = k;
    }
  candidate.normal = normal(chosen);
  candidate.gap = std::min(m.gap, axes.start_separation[chosen][lane]);
  return true;
}

// The owners (nodes) of a pair, and the separation by which pairs of the same owners are compared.
struct OwnedPair {
  std::uint32_t low, high;
  double separation;  // TrianglePlanes::end_separations()
};

// For each pair of owners, the `most` pairs with the least separations, in the order of `pairs`.
// `owned` describes `pairs`.
Pairs closest_pairs(const Pairs& pairs, const std::vector<OwnedPair>& owned, const CandidateLimit& limit) {
  struct Entry {
    double separation;
    BroadPhase::Pair triangles;
    std::uint32_t pair;
    // A total order, so that the choice does not depend on the order of pairs.
    bool operator<(const Entry& o) const {
      return std::tie(separation, triangles) < std::tie(o.separation, o.triangles);
    }
  };
  struct Neighbour {
    std::uint32_t owner;         // the higher of the two owners
    std::vector<Entry> closest;  // ascending
  };
  // Bucket sort by the lower owner. Bucket 0 holds triangles without an owner (~0u + 1 = 0).
  std::size_t buckets = 1;
  for (const auto o : limit.owner) buckets = std::max<std::size_t>(buckets, o + 2u);
  std::vector<std::uint32_t> first(buckets + 1, 0);
  for (const OwnedPair& p : owned) ++first[p.low + 1u + 1];
  for (std::size_t o = 0; o < buckets; ++o) first[o + 1] += first[o];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1), order(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) order[next[owned[i].low + 1u]++] = i;
  std::vector<std::uint8_t> keep(pairs.size(), 0);
  parallel_for(buckets, 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbour> neighbours;
    for (std::size_t o = begin; o < end; ++o) {
      if (first[o + 1] - first[o] <= limit.most) {
        for (auto k = first[o]; k < first[o + 1]; ++k) keep[order[k]] = 1;
        continue;
      }
      std::size_t count = 0;  // neighbours in use; the others keep their memory
      for (auto k = first[o]; k < first[o + 1]; ++k) {
        const OwnedPair& p = owned[order[k]];
        const Entry entry{p.separation, pairs[order[k]], order[k]};
        std::size_t c = 0;
        while (c < count && neighbours[c].owner != p.high) ++c;
        if (c == count) {
          if (++count > neighbours.size()) neighbours.emplace_back();
          neighbours[c].owner = p.high;
          neighbours[c].closest.clear();
        }
        auto& closest = neighbours[c].closest;
        if (closest.size() == limit.most && !(entry < closest.back())) continue;
        if (closest.size() == limit.most) closest.pop_back();
        closest.insert(std::upper_bound(closest.begin(), closest.end(), entry), entry);
      }
      for (std::size_t c = 0; c < count; ++c)
        for (const Entry& e : neighbours[c].closest) keep[e.pair] = 1;
    }
  });
  Pairs result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (keep[i]) result.push_back(pairs[i]);
  return result;
}

// Updates the broad phase in a frame that moves with the surface by the affine fit.
void update_broad_phase(const SurfaceMotion& m, const RepresentativeSurface& surface, BroadPhase& broad_phase) {
  std::vector<Vec3> fitted = m.from;
  if (!surface.vertices.empty()) apply_affine_fit(surface.vertices, m.from, m.to, fitted);
  // Boxes contain the start, too: a vertex may stay there.
  Vec3 start_centroid = Vec3::Zero();
  for (const auto v : surface.vertices) start_centroid += m.from[v] / double(surface.vertices.size());
  std::vector<Vec3> part;
  const std::vector<Vec3>* to = &m.to;
  const auto box_of = [&](std::size_t t) {
    Box3 box = surface.swept_box(t, fitted, *to);
    for (const auto v : surface.triangles[t]) box.add(m.from[v] - start_centroid);
    return box.grown(0.5 * m.reach);
  };
  broad_phase.update_for_share(m.triangles, box_of, 0, [&](double share) {
    part = share_of_motion(surface.vertices, fitted, m.to, share);
    to = &part;
  });
}

// The pairs of the broad phase that cheap axes do not cull, at most the limit for each pair of
// owners.
Pairs cull(const SurfaceMotion& m, const RepresentativeSurface& surface, BroadPhase& broad_phase,
           const CandidateLimit& limit) {
  constexpr std::size_t chunk = 1024;
  constexpr double margin = 1 + 1e-9;  // for rounding: set_candidate() must reach the same decision
  const auto& near = broad_phase.pairs();
  TrianglePlanes& planes = broad_phase.planes();
  planes.compute(surface.triangles, m.from, m.to);
  std::vector<Pairs> chunks((near.size() + chunk - 1) / chunk);
  std::vector<std::vector<OwnedPair>> owned_chunks(chunks.size());
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      for (std::size_t i = c * chunk; i < std::min(near.size(), (c + 1) * chunk); ++i)
        if (const auto& [s, t] = near[i]; !surface.share_representative(s, t)) chunks[c].push_back({s, t});
      planes.remove_separated(chunks[c], m.gap, m.reach);
      planes.remove_centroid_separated(chunks[c], margin * m.gap, margin * m.reach);
      if (limit.owner.empty()) continue;
      const std::vector<double> separation = planes.end_separations(chunks[c]);
      for (std::size_t i = 0; i < chunks[c].size(); ++i) {
        const auto owner = [&](std::uint32_t t) { return limit.owner[surface.triangles[t][0]]; };
        const auto low_high = std::minmax({owner(chunks[c][i].first), owner(chunks[c][i].second)});
        owned_chunks[c].push_back({low_high.first, low_high.second, separation[i]});
      }
    }
  });
  Pairs pairs;
  std::vector<OwnedPair> owned;
  for (const auto& c : chunks) pairs.insert(pairs.end(), c.begin(), c.end());
  for (const auto& c : owned_chunks) owned.insert(owned.end(), c.begin(), c.end());
  return limit.owner.empty() ? pairs : closest_pairs(pairs, owned, limit);
}

}  // namespace

std::vector<ContactCandidate> find_contact_candidates(const SurfaceMotion& m, BroadPhase& broad_phase,
                                                      const CandidateLimit& limit) {
  const RepresentativeSurface surface(m);
  update_broad_phase(m, surface, broad_phase);
  const Pairs pairs = cull(m, surface, broad_phase, limit);
  constexpr std::size_t chunk = 256;
  std::vector<std::vector<ContactCandidate>> found((pairs.size() + chunk - 1) / chunk);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto simplex_pair = [&](std::size_t i) {
        const auto &a = surface.triangles[pairs[i].first], &b = surface.triangles[pairs[i].second];
        return SimplexPair{{{a[0], a[1], a[2]}, 3}, {{b[0], b[1], b[2]}, 3}};
      };
      const auto examine = [&](std::size_t i, const CandidateAxes& axes, std::size_t lane) {
        const SimplexPair pair = simplex_pair(i);
        ContactCandidate candidate{.a = pair.a, .b = pair.b, .normal = Vec3::Zero(), .closest = {}, .gap = 0};
        if (set_candidate(m, axes, lane, candidate)) found[c].push_back(candidate);
      };
      CandidateAxisBatch<decltype(examine)> batch(m.from, m.to, false, examine);
      for (std::size_t i = c * chunk; i < std::min(pairs.size(), (c + 1) * chunk); ++i) batch.add(simplex_pair(i), i);
      batch.finish();
    }
  });
  std::vector<ContactCandidate> result;
  for (const auto& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

}  // namespace geo
