// Trial moves of gap/2 · 4^(−k), k = 0 … 4, of all opening vertices at once: into the material,
// then to the targets. Vertices whose triangles cross (exact test) close again and are tried one by
// one (docs/decisions/079, 117).
#include "contact/surface/open_sheets.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/detection/find_crossings.h"
#include "geometry/aabb_tree.h"

namespace geo {
namespace {

using Representatives = std::vector<std::uint32_t>;

constexpr std::uint32_t no_vertex = ~0u;

// Normals of a closed sheet's vertices.
struct SheetNormals {
  std::vector<Vec3> all;     // of all triangles at a vertex
  std::vector<Vec3> across;  // normals_across_sheets()
};

// Whether the targets of two copies come apart: with d = to_a − to_b and n the normalised
// difference of unit normals across, n · d > opening or |d − (n · d) n| > 3 opening.
bool come_apart(const SheetNormals& normals, std::uint32_t a, std::uint32_t b, const Vec3& apart, double opening) {
  const Vec3 n = (normals.across[b].normalized() - normals.across[a].normalized()).normalized();
  const double along = n.dot(apart);
  return along > opening || (apart - along * n).norm() > 3 * opening;
}

// Representatives of which two copies have targets that come apart.
Representatives find_opening(const CoincidentVertices& coincident, const SheetNormals& normals,
                             const std::vector<Vec3>& to, double opening) {
  Representatives result;
  for (std::uint32_t v = 0; v < coincident.size(); ++v) {
    const auto& copies = coincident[v];
    bool opens = false;
    for (std::size_t i = 0; i < copies.size() && !opens; ++i)
      for (std::size_t j = i + 1; j < copies.size() && !opens; ++j)
        opens = come_apart(normals, copies[i], copies[j], to[copies[i]] - to[copies[j]], opening);
    if (opens) result.push_back(v);
  }
  return result;
}

class SheetOpener {
 public:
  SheetOpener(const ContactSurface& surface, const CoincidentVertices& coincident, SheetNormals normals,
              const std::vector<Vec3>& to, double gap, std::vector<Vec3>& positions)
      : surface_(surface),
        coincident_(coincident),
        normals_(std::move(normals.all)),
        to_(to),
        gap_(gap),
        closed_(positions),
        positions_(positions),
        inward_(std::move(normals.across)) {}

  // Returns the number of representatives that remain closed.
  std::size_t run(const Representatives& opening) {
    find_pairs(opening);
    Representatives closed = opening;
    for (int trial = 0; !closed.empty() && trial < trials_of_ways * ways_of_normals; ++trial)
      closed = open_at_once(closed, trial / ways_of_normals, trial % ways_of_normals == 0 ? Way::inward : Way::normal);
    for (int trial = 0; !closed.empty() && trial < trials_of_ways; ++trial)
      closed = open_at_once(closed, trial, Way::to_target);
    return open_one_by_one(closed);
  }

 private:
  // Smaller moves for vertices whose triangles would cross: five lengths, each a quarter of the one
  // before, so that the last is gap / 512. Vertices that do not open by that have no space, and
  // stay closed until the next step.
  static constexpr int trials_of_ways = 5;
  static constexpr int ways_of_normals = 2;

  // Where a copy goes: against the normal of the coincident triangles around it; against that of
  // all its triangles; or to its target. Where all around it has opened and slid on, a closed copy
  // is the tip of a spike, its normals are those of the spike's flanks, and the way back is to the
  // target.
  enum class Way { inward, normal, to_target };

  // The motion of copy c of a closed vertex, in a trial.
  Vec3 move_of(std::uint32_t c, Way way, int trial) const {
    const double step = std::ldexp(0.5 * gap_, -2 * trial);
    if (way != Way::to_target) return -step * (way == Way::inward ? inward_ : normals_)[c].normalized();
    const Vec3 lag = to_[c] - closed_[c];
    return std::min(step, lag.norm()) * lag.normalized();
  }

  // Pairs of triangles that may meet while opening vertices move by at most half a gap.
  void find_pairs(const Representatives& opening) {
    std::vector<std::uint8_t> moving(positions_.size(), 0);
    for (const auto v : opening)
      for (const auto c : coincident_[v]) moving[c] = 1;
    std::vector<Box3> boxes(surface_.triangles.size());
    std::vector<std::uint8_t> marked(boxes.size(), 0);
    Box3 region;
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      const auto& [a, b, c] = surface_.triangles[t];
      boxes[t] = box_of(positions_[a], positions_[b], positions_[c]).grown(0.5 * gap_);
      if (moving[a] || moving[b] || moving[c]) {
        region.add(boxes[t]);
        marked[t] = 1;
      }
    }
    for (Box3& box : boxes)
      if (!box.meets(region)) box = Box3();
    pairs_ = overlapping_pairs(boxes, &marked);
  }

  // Moves all given vertices, then closes those whose triangles cross, until nothing crosses.
  // Returns the vertices that were closed.
  Representatives open_at_once(const Representatives& opening, int trial, Way way) {
    Representatives refused;
    std::vector<std::uint8_t> moved(positions_.size(), 0), marked(surface_.triangles.size(), 0),
        crosses(positions_.size(), 0);
    for (const auto v : opening)
      for (const auto c : coincident_[v]) {
        positions_[c] += move_of(c, way, trial);
        moved[c] = 1;
      }
    for (;;) {
      for (std::size_t t = 0; t < marked.size(); ++t)
        marked[t] =
            std::any_of(surface_.triangles[t].begin(), surface_.triangles[t].end(), [&](auto v) { return moved[v]; });
      const auto crossings = find_crossings(pairs_, surface_.triangles, positions_,
                                            coincident_representatives(surface_.site, positions_), true, &marked);
      if (crossings.empty()) break;
      for (const auto& [s, t] : crossings)
        for (const auto& triangle : {surface_.triangles[s], surface_.triangles[t]})
          for (const auto v : triangle) crosses[v] = 1;
      bool closed_any = false;
      for (const auto v : opening)
        if (std::any_of(coincident_[v].begin(), coincident_[v].end(), [&](auto c) { return crosses[c] && moved[c]; })) {
          for (const auto c : coincident_[v]) {
            positions_[c] = closed_[v];
            moved[c] = 0;
          }
          refused.push_back(v);
          closed_any = true;
        }
      if (!closed_any) break;
    }
    return refused;
  }

  // Opens vertices one after another, since others may have been in the way. Tries moves of all
  // copies, of all but the first, and of each alone. Returns the number of vertices that stay
  // closed.
  std::size_t open_one_by_one(Representatives closed) {
    auto representative = coincident_representatives(surface_.site, positions_);
    auto pairs_of = pairs_at(closed);
    std::size_t next = 0;
    return std::erase_if(closed, [&](auto v) {
      auto& pairs = pairs_of[next++];
      const auto opens = [&](int trial, Way way) {
        const std::span<const std::uint32_t> copies = coincident_[v];
        const auto opens_as = [&](const auto& moves) {
          std::uint32_t staying = no_vertex;
          for (const auto c : copies) {
            positions_[c] = moves(c) ? Vec3(closed_[v] + move_of(c, way, trial)) : closed_[v];
            if (!moves(c) && staying == no_vertex) staying = c;
            representative[c] = moves(c) ? c : staying;
          }
          return !any_crosses(pairs, representative);
        };
        if (opens_as([](std::uint32_t) { return true; })) return true;
        if (opens_as([&](std::uint32_t c) { return c != copies[0]; })) return true;
        // Where sheets meet, some copies may part and others not.
        return copies.size() > 2 && std::any_of(copies.begin(), copies.end(), [&](std::uint32_t one) {
                 return opens_as([one](std::uint32_t c) { return c == one; });
               });
      };
      for (int trial = 0; trial < trials_of_ways; ++trial)
        if (opens(trial, Way::inward) || opens(trial, Way::normal)) return false;
      for (int trial = 0; trial < trials_of_ways; ++trial)
        if (opens(trial, Way::to_target)) return false;
      for (const auto c : coincident_[v]) {
        positions_[c] = closed_[v];
        representative[c] = v;
      }
      return true;
    });
  }

  // Whether a pair crosses. That pair becomes the first: it is likely to cross in the next trial,
  // too.
  bool any_crosses(std::vector<TrianglePair>& pairs, std::span<const std::uint32_t> representative) const {
    const auto represented = [&](std::uint32_t t) {
      const auto& [a, b, c] = surface_.triangles[t];
      return Triangle{representative[a], representative[b], representative[c]};
    };
    const auto at = std::find_if(pairs.begin(), pairs.end(), [&](const TrianglePair& p) {
      return triangles_cross(represented(p.first), represented(p.second), positions_, true);
    });
    if (at == pairs.end()) return false;
    std::iter_swap(pairs.begin(), at);
    return true;
  }

  // For each of the vertices the pairs with a triangle at one of its copies.
  std::vector<std::vector<TrianglePair>> pairs_at(const Representatives& vertices) const {
    std::vector<std::vector<TrianglePair>> result(vertices.size());
    if (vertices.empty()) return result;
    std::vector<std::uint32_t> number(positions_.size(), ~0u);  // per vertex: of its representative in `vertices`
    for (std::uint32_t k = 0; k < vertices.size(); ++k)
      for (const auto c : coincident_[vertices[k]]) number[c] = k;
    for (const auto& pair : pairs_)
      for (const auto t : {pair.first, pair.second})
        for (const auto c : surface_.triangles[t])
          if (number[c] != ~0u && (result[number[c]].empty() || result[number[c]].back() != pair))
            result[number[c]].push_back(pair);
    return result;
  }

  const ContactSurface& surface_;
  const CoincidentVertices& coincident_;
  const std::vector<Vec3> normals_;
  const std::vector<Vec3>& to_;
  double gap_;
  const std::vector<Vec3> closed_;  // positions before
  std::vector<Vec3>& positions_;
  std::vector<TrianglePair> pairs_;
  std::vector<Vec3> inward_;  // per vertex: normals_across_sheets()
};

}  // namespace

std::size_t open_sheets(const ContactSurface& surface, const VertexFans& fans, const Coincidence& coincidence,
                        const std::vector<Vec3>& to, double gap, double opening, std::vector<Vec3>& positions) {
  const auto& [representative, coincident] = coincidence;
  SheetNormals normals{.all = vertex_normals(surface, fans, coincident, positions), .across = {}};
  normals.across = normals_across_sheets(surface, representative, normals.all, positions);
  const Representatives candidates = find_opening(coincident, normals, to, opening);
  if (candidates.empty()) return 0;
  return candidates.size() - SheetOpener(surface, coincident, std::move(normals), to, gap, positions).run(candidates);
}

}  // namespace geo
