// An edge with several pairs of triangles gets a vertex of its own for each pair, at its middle.
// The widest fan at a place stays. The vertices of the others move against the mean normal of their
// triangles; where triangles then cross, half as far, in a direction changed at random.
#include "crack/part_touching.h"

#include <algorithm>
#include <map>

#include "base/random.h"
#include "geometry/box_pairs.h"
#include "geometry/triangle_index.h"
#include "kerf/check.h"
#include "kerf/error.h"

namespace geo::crack {
namespace {

// A round halves the motions of vertices whose triangles cross, so that 64 reach below rounding.
constexpr int max_rounds = 64;

using Key = std::pair<std::uint32_t, std::uint32_t>;

Key key_of(const Triangle& t, std::size_t k) { return std::minmax(t[k], t[(k + 1) % 3]); }

// Divides the pairs of triangles at edges of more than two triangles.
class EdgeDivision {
 public:
  explicit EdgeDivision(PairedSurface& s) : s_(s), mesh_(s.mesh) {
    for (const Triangle& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) ++uses_[key_of(t, k)];
    std::erase_if(uses_, [](const auto& use) { return use.second <= 2; });
    for (const auto site : mesh_.site) sites_ = std::max(sites_, site + 1);
  }

  void run() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto use = uses_.find(key_of(mesh_.triangles[t], k)); use != uses_.end()) divide(t, k, use->first);
  }

 private:
  // Divides triangle t, and the one beside it, at the middle of the edge from corner k.
  void divide(std::uint32_t t, std::size_t k, const Key& key) {
    const std::uint32_t u = s_.beside[t][k];
    std::size_t j = 0;
    while (s_.beside[u][j] != t || key_of(mesh_.triangles[u], j) != key) ++j;
    const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(0.5 * (mesh_.vertices[key.first] + mesh_.vertices[key.second]));
    const auto [site, fresh] = middle_site_.try_emplace(key, sites_);
    sites_ += fresh;
    mesh_.site.push_back(site->second);
    const std::uint32_t t2 = halve(t, k, middle), u2 = halve(u, j, middle);
    s_.beside[t][k] = u2;
    s_.beside[u2][j] = t;
    s_.beside[t2][k] = u;
    s_.beside[u][j] = t2;
  }

  // Triangle t keeps the half at corner k; the other one, with the same corner numbers, is new.
  std::uint32_t halve(std::uint32_t t, std::size_t k, std::uint32_t middle) {
    const auto other = static_cast<std::uint32_t>(mesh_.triangles.size());
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    Triangle half = mesh_.triangles[t];
    auto beside = s_.beside[t];
    half[k] = middle;
    mesh_.triangles[t][l] = middle;
    for (auto& back : s_.beside[beside[l]])
      if (back == t && shares(beside[l], &back - s_.beside[beside[l]].data(), half[l], half[m])) back = other;
    beside[m] = t;
    s_.beside[t][l] = other;
    mesh_.triangles.push_back(half);
    s_.beside.push_back(beside);
    return other;
  }
  bool shares(std::uint32_t t, std::ptrdiff_t k, std::uint32_t a, std::uint32_t b) const {
    return key_of(mesh_.triangles[t], static_cast<std::size_t>(k)) == Key(std::minmax(a, b));
  }

  PairedSurface& s_;
  TriangleMesh& mesh_;
  std::map<Key, int> uses_;                   // edges with more than two triangles
  std::map<Key, std::uint32_t> middle_site_;  // of their middles
  std::uint32_t sites_ = 0;
};

struct Motion {
  std::uint32_t vertex;
  Vec3 from, inwards;  // inwards: unit
  double length;
};

// The measures of a vertex that decide how it moves.
struct Fan {
  Vec3 outwards = Vec3::Zero();  // mean normal of its triangles, weighted by area
  double shortest = 1e300;       // length of its edges
  double flare = 0;  // Σ over its edges: cosine of the angle to `outwards`; large where the material is wide
};

std::vector<Fan> fans_of(const TriangleMesh& mesh) {
  std::vector<Fan> fans(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 normal = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : {a, b, c}) fans[v].outwards += normal;
  }
  for (Fan& fan : fans) fan.outwards = fan.outwards.stableNormalized();
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]];
      const double length = edge.norm();
      fans[t[k]].flare += edge.dot(fans[t[k]].outwards) / length;
      for (const auto v : {t[k], t[(k + 1) % 3]}) fans[v].shortest = std::min(fans[v].shortest, length);
    }
  return fans;
}

// The motions of the vertices that share their place, but for the widest one at each place;
// `motion_of`: per vertex, ~0u for none.
std::vector<Motion> motions_of(const TriangleMesh& mesh, std::vector<std::uint32_t>& motion_of) {
  const std::vector<Fan> fans = fans_of(mesh);
  std::map<std::uint32_t, std::vector<std::uint32_t>> at_site;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) at_site[mesh.site[v]].push_back(v);
  std::vector<Motion> motions;
  motion_of.assign(mesh.vertices.size(), ~0u);
  for (auto& [site, vertices] : at_site) {
    const auto widest = std::max_element(vertices.begin(), vertices.end(),
                                         [&](auto v, auto w) { return fans[v].flare < fans[w].flare; });
    for (const auto v : vertices) {
      if (v == *widest) continue;
      motion_of[v] = static_cast<std::uint32_t>(motions.size());
      motions.push_back(
          {.vertex = v, .from = mesh.vertices[v], .inwards = -fans[v].outwards, .length = 0x1p-12 * fans[v].shortest});
    }
  }
  return motions;
}

// The pairs of triangles that cross, kept up to date while vertices move.
class CrossingPairs {
 public:
  explicit CrossingPairs(const TriangleMesh& mesh) : mesh_(mesh) {
    std::vector<Box3> boxes;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) boxes.push_back(box(t));
    pairs_ = meeting_pairs(boxes, [&](AabbTree::Pairs& some) {
      std::erase_if(some, [&](const auto& pair) { return !cross(pair.first, pair.second); });
    });
    if (pairs_.empty()) return;
    index_.reserve(boxes.size());
    for (std::uint32_t t = 0; t < boxes.size(); ++t) index_.insert(t, boxes[t]);
  }
  // `moved`: all triangles with a vertex that has moved, ascending.
  void update(const std::vector<std::uint32_t>& moved) {
    const auto in = [&](std::uint32_t t) { return std::binary_search(moved.begin(), moved.end(), t); };
    std::erase_if(pairs_, [&](const auto& pair) { return in(pair.first) || in(pair.second); });
    for (const auto t : moved) {
      index_.erase(t);
      index_.insert(t, box(t));
    }
    for (const auto t : moved) {
      near_.clear();
      index_.find(index_.box(t), near_);
      for (const auto other : near_)
        if (other != t && !(other < t && in(other)) && cross(t, other)) pairs_.push_back({t, other});
    }
  }
  const AabbTree::Pairs& pairs() const { return pairs_; }

 private:
  std::array<Vec3, 3> corners(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
  }
  Box3 box(std::uint32_t t) const {
    const auto p = corners(t);
    return box_of(p[0], p[1], p[2]);
  }
  bool cross(std::uint32_t t, std::uint32_t u) const {
    return faces_cross(mesh_.triangles[t], corners(t), mesh_.triangles[u], corners(u));
  }

  const TriangleMesh& mesh_;
  AabbTree::Pairs pairs_;
  TriangleIndex index_;
  std::vector<std::uint32_t> near_;
};

void sort_unique(std::vector<std::uint32_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// The motions of the corners of triangles that cross. Throws where a pair has none.
std::vector<std::uint32_t> motions_in(const TriangleMesh& mesh, const AabbTree::Pairs& crossing,
                                      const std::vector<std::uint32_t>& motion_of) {
  std::vector<std::uint32_t> motions;
  for (const auto& [t, u] : crossing) {
    const std::size_t before = motions.size();
    for (const auto triangle : {t, u})
      for (const auto v : mesh.triangles[triangle])
        if (motion_of[v] != ~0u) motions.push_back(motion_of[v]);
    if (motions.size() == before) throw GeometryError("parts that touch cannot be moved apart");
  }
  sort_unique(motions);
  return motions;
}

void move_apart(TriangleMesh& mesh) {
  std::vector<std::uint32_t> motion_of;
  std::vector<Motion> motions = motions_of(mesh, motion_of);
  if (motions.empty()) return;
  std::vector<std::vector<std::uint32_t>> triangles_at(motions.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const auto v : mesh.triangles[t])
      if (motion_of[v] != ~0u) triangles_at[motion_of[v]].push_back(t);
  const auto move = [&](const Motion& m) { mesh.vertices[m.vertex] = m.from + m.length * m.inwards; };
  for (const Motion& m : motions) move(m);
  Random random(mesh.triangles.size());
  CrossingPairs crossing(mesh);
  for (int rounds = 0; !crossing.pairs().empty(); ++rounds) {
    if (rounds == max_rounds) throw GeometryError("parts that touch cannot be moved apart");
    std::vector<std::uint32_t> moved;
    for (const auto m : motions_in(mesh, crossing.pairs(), motion_of)) {
      motions[m].length *= 0.5;
      const Vec3 direction = random.direction();
      motions[m].inwards = (motions[m].inwards + random.uniform() * direction).stableNormalized();
      move(motions[m]);
      moved.insert(moved.end(), triangles_at[m].begin(), triangles_at[m].end());
    }
    sort_unique(moved);
    crossing.update(moved);
  }
}

}  // namespace

void part_touching(PairedSurface& surface) {
  EdgeDivision(surface).run();
  move_apart(surface.mesh);
}

}  // namespace geo::crack
