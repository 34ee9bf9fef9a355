// Walls are refined by longest-edge bisection and displaced by fractal noise in each coordinate,
// Σ_o 0.6^o · noise_o(2^o · frequency · p). Where triangles cross (exact test, spatial index), the
// displacement of their vertices is halved, and dropped at the fourth time.
#include "score/jagged.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "base/union_find.h"
#include "crack/index_map.h"
#include "crack/noise.h"
#include "geometry/aabb_tree.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return {mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]};
}

// Whether each triangle is in the material or at most `margin` outside.
std::vector<std::uint8_t> near_or_inside(const TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  const std::size_t count = walls.triangles.size();
  const double rounding =
      0x1p-40 * (skin.box().diagonal() + skin.box().lo.cwiseAbs().cwiseMax(skin.box().hi.cwiseAbs()).maxCoeff());
  std::vector<std::uint8_t> keep(count), clear(count);  // clear: certainly without a point of the skin
  std::vector<Vec3> middle(count);
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto c = corners(walls, t);
      middle[t] = (c[0] + c[1] + c[2]) / 3;
      double radius = margin;
      for (const Vec3& p : c) radius = std::max(radius, margin + (p - middle[t]).norm());
      const auto found = skin.closest(middle[t], (1 + 0x1p-40) * radius + rounding, radius);
      clear[t] = found.triangle == ~0u;
      keep[t] = !clear[t] && (found.distance <= radius || skin.inside(middle[t]));
    }
  });
  // Clear triangles that are connected are all inside, or all outside.
  UnionFind joined(count);
  std::vector<std::uint32_t> at(walls.vertices.size(), ~0u);
  for (std::uint32_t t = 0; t < count; ++t)
    for (const auto v : walls.triangles[t]) {
      if (!clear[t]) break;
      if (at[v] == ~0u) at[v] = t;
      joined.unite(at[v], t);
    }
  for (std::uint32_t t = 0; t < count; ++t)
    if (clear[t]) keep[t] = joined.find(t) == t ? skin.inside(middle[t]) : keep[joined.find(t)];
  return keep;
}

// Drops the triangles farther outside the material than `margin`, and vertices without triangles.
void trim(TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  const auto keep = near_or_inside(walls, skin, margin);
  std::vector<std::uint32_t> index(walls.vertices.size(), ~0u);
  TriangleMesh kept;
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    Triangle triangle = walls.triangles[t];
    for (auto& v : triangle) {
      if (index[v] == ~0u)
        index[v] = static_cast<std::uint32_t>(kept.vertices.size()), kept.vertices.push_back(walls.vertices[v]);
      v = index[v];
    }
    kept.triangles.push_back(triangle);
  }
  walls = std::move(kept);
}

// The triangles at each edge, in the order in which they were added.
class EdgeTriangles {
 public:
  struct Use {
    std::uint32_t triangle, next;  // next: index into uses, ~0u: none
  };
  std::vector<Use> uses;

  // The edge's first use, ~0u for none.
  std::uint32_t first(std::uint32_t a, std::uint32_t b) { return list(a, b).first; }
  // Adds a triangle to an edge. True when it is the first one.
  bool add(std::uint32_t a, std::uint32_t b, std::uint32_t triangle) {
    const auto use = static_cast<std::uint32_t>(uses.size());
    uses.push_back({triangle, ~0u});
    List& at = list(a, b);
    const bool is_first = at.first == ~0u;
    (is_first ? at.first : uses[at.last].next) = use;
    at.last = use;
    return is_first;
  }
  void replace(std::uint32_t a, std::uint32_t b, std::uint32_t triangle, std::uint32_t by) {
    for (auto u = first(a, b); u != ~0u; u = uses[u].next)
      if (uses[u].triangle == triangle) uses[u].triangle = by;
  }

 private:
  struct List {
    std::uint32_t first = ~0u, last = ~0u;
  };
  List& list(std::uint32_t a, std::uint32_t b) {
    std::uint32_t& index = indices_[std::uint64_t(std::min(a, b)) << 32 | std::max(a, b)];
    if (index == ~0u) index = static_cast<std::uint32_t>(lists_.size()), lists_.emplace_back();
    return lists_[index];
  }
  crack::IndexMap<std::uint64_t, crack::SpreadHash> indices_;  // into lists_, by edge
  std::vector<List> lists_;
};

// Bisects edges, the longest first: each is then the longest of all its triangles, so that small
// angles stay bounded.
void divide(TriangleMesh& walls, double longest) {
  struct Edge {
    double length2;
    std::uint32_t a, b;
    bool operator<(const Edge& o) const { return std::tie(length2, o.a, o.b) < std::tie(o.length2, a, b); }
  };
  EdgeTriangles at;
  std::priority_queue<Edge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t t) {
    if (!at.add(a, b, t)) return;
    const double length2 = (walls.vertices[a] - walls.vertices[b]).squaredNorm();
    if (length2 > longest * longest) edges.push({length2, std::min(a, b), std::max(a, b)});
  };
  for (std::uint32_t t = 0; t < walls.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) add(walls.triangles[t][k], walls.triangles[t][(k + 1) % 3], t);
  while (!edges.empty()) {
    const Edge e = edges.top();
    edges.pop();
    const auto middle = static_cast<std::uint32_t>(walls.vertices.size());
    walls.vertices.push_back(0.5 * (walls.vertices[e.a] + walls.vertices[e.b]));
    for (auto use = at.first(e.a, e.b); use != ~0u; use = at.uses[use].next) {
      const std::uint32_t t = at.uses[use].triangle, other = static_cast<std::uint32_t>(walls.triangles.size());
      Triangle half = walls.triangles[t];
      std::uint32_t apex = 0;
      for (const auto v : half)
        if (v != e.a && v != e.b) apex = v;
      std::replace(walls.triangles[t].begin(), walls.triangles[t].end(), e.b, middle);
      std::replace(half.begin(), half.end(), e.a, middle);
      walls.triangles.push_back(half);
      at.replace(e.b, apex, t, other);
      add(middle, apex, t), add(e.a, middle, t);
      at.add(middle, apex, other);
      add(middle, e.b, other);
    }
  }
}

// Finds triangles that cross each other, incrementally.
class Crossings {
 public:
  explicit Crossings(const TriangleMesh& walls) : walls_(walls), at_(walls.vertices.size()) {
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t)
      for (const auto v : walls.triangles[t]) at_[v].push_back(t);
  }

  // The vertices, ascending, of crossing triangles: among all, or after update(), of pairs with a
  // moved vertex.
  std::vector<std::uint32_t> vertices() {
    std::vector<Box3> boxes;
    boxes.reserve(walls_.triangles.size());
    for (std::size_t t = 0; t < walls_.triangles.size(); ++t) {
      const auto c = corners(walls_, t);
      boxes.push_back(box_of(c[0], c[1], c[2]));
    }
    if (tree_.boxes().empty())
      tree_ = AabbTree(std::move(boxes));
    else
      tree_.refit_or_rebuild(std::move(boxes), {});
    std::vector<std::uint32_t> all;
    for (const auto& [t, other] :
         tree_.pairs(changed_.empty() ? nullptr : &changed_, [this](AabbTree::Pairs& pairs) { keep_crossing(pairs); }))
      for (const auto each : {t, other})
        all.insert(all.end(), walls_.triangles[each].begin(), walls_.triangles[each].end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  // Marks the triangles at moved vertices.
  void update(const std::vector<std::uint32_t>& vertices) {
    changed_.assign(walls_.triangles.size(), 0);
    for (const auto v : vertices)
      for (const auto t : at_[v]) changed_[t] = 1;
  }

 private:
  void keep_crossing(AabbTree::Pairs& pairs) const {
    std::erase_if(pairs, [this](const auto& pair) {
      return !faces_cross(walls_.triangles[pair.first], corners(walls_, pair.first), walls_.triangles[pair.second],
                          corners(walls_, pair.second));
    });
  }

  const TriangleMesh& walls_;
  std::vector<std::vector<std::uint32_t>> at_;  // triangles at each vertex
  std::vector<std::uint8_t> changed_;           // per triangle; empty: all
  AabbTree tree_;
};

}  // namespace

void refine_walls(TriangleMesh& walls, const TriangleBvh& skin, double longest, double margin) {
  // Coarsely first: few triangles are divided that are dropped afterwards. The factors change the
  // cost and where triangles are bisected, not the bound on their edges.
  for (const double edge : {8 * longest, 2 * longest, longest}) {
    divide(walls, edge);
    trim(walls, skin, margin);
  }
}

void roughen_walls(TriangleMesh& walls, const TriangleBvh& skin, const JaggedOptions& o) {
  if (!(o.amplitude >= 0 && o.amplitude < 1) || !(o.frequency > 0 && o.frequency <= 1e4) || o.octaves < 1 ||
      o.octaves > 16 || !(o.edge >= 0))
    throw InputError(
        "the jaggedness's amplitude must be in [0, 1), its frequency positive and at most 10000, its octaves 1 to 16");
  const double size = skin.box().diagonal();
  refine_walls(walls, skin, size * (o.edge > 0 ? o.edge : 1 / (8 * o.frequency)), 4 * o.amplitude * size);
  const std::vector<Vec3> flat = walls.vertices;
  std::vector<Vec3> offset(flat.size(), Vec3::Zero());
  parallel_for(flat.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double height = o.amplitude * size, frequency = o.frequency / size;
      for (int octave = 0; octave < o.octaves; ++octave, height *= 0.6, frequency *= 2) {
        const std::uint64_t seed = o.seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(octave * 3);
        const auto noise = gradient_noises(frequency * (flat[i] - skin.box().lo), {seed, seed + 1, seed + 2});
        for (int k = 0; k < 3; ++k) offset[i][k] += height * noise[std::size_t(k)];
      }
      walls.vertices[i] = flat[i] + offset[i];
    }
  });
  std::vector<int> lowered(flat.size());
  Crossings crossings(walls);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::uint32_t> bad = crossings.vertices();
    std::erase_if(bad, [&](std::uint32_t v) { return offset[v].isZero(0); });
    for (const auto v : bad) {
      offset[v] *= ++lowered[v] < 4 ? 0.5 : 0;
      walls.vertices[v] = flat[v] + offset[v];
      changed = true;
    }
    crossings.update(bad);
  }
  trim(walls, skin, 0);
}

}  // namespace geo
