// Walls are refined by longest-edge bisection and displaced by fractal noise in each coordinate,
// Σ_o 0.6^o · noise_o(2^o · frequency · p). Where triangles cross (exact test, spatial index), the
// displacement of their vertices is halved, and dropped at the fourth time.
#include "score/jagged.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>

#include "crack/noise.h"
#include "geometry/triangle_index.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return {mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]};
}

// Drops the triangles farther outside the material than `margin`, and vertices without triangles.
void trim(TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  std::vector<char> keep(walls.triangles.size());
  parallel_for(keep.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto c = corners(walls, t);
      const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
      double radius = margin;
      for (const Vec3& p : c) radius = std::max(radius, margin + (p - middle).norm());
      keep[t] = skin.closest(middle, radius).triangle != ~0u || skin.inside(middle);
    }
  });
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

// Bisects edges, the longest first: each is then the longest of all its triangles, so that small
// angles stay bounded.
void divide(TriangleMesh& walls, double longest) {
  struct Edge {
    double length2;
    std::uint32_t a, b;
    bool operator<(const Edge& o) const { return std::tie(length2, o.a, o.b) < std::tie(o.length2, a, b); }
  };
  const auto key = [](std::uint32_t a, std::uint32_t b) {
    return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
  };
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> at;
  std::priority_queue<Edge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t t) {
    auto& triangles = at[key(a, b)];
    triangles.push_back(t);
    const double length2 = (walls.vertices[a] - walls.vertices[b]).squaredNorm();
    if (triangles.size() == 1 && length2 > longest * longest) edges.push({length2, std::min(a, b), std::max(a, b)});
  };
  for (std::uint32_t t = 0; t < walls.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) add(walls.triangles[t][k], walls.triangles[t][(k + 1) % 3], t);
  while (!edges.empty()) {
    const Edge e = edges.top();
    edges.pop();
    auto node = at.extract(key(e.a, e.b));
    if (node.empty()) continue;
    const auto middle = static_cast<std::uint32_t>(walls.vertices.size());
    walls.vertices.push_back(0.5 * (walls.vertices[e.a] + walls.vertices[e.b]));
    for (const auto t : node.mapped()) {
      const auto other = static_cast<std::uint32_t>(walls.triangles.size());
      Triangle half = walls.triangles[t];
      std::uint32_t apex = 0;
      for (const auto v : half)
        if (v != e.a && v != e.b) apex = v;
      std::replace(walls.triangles[t].begin(), walls.triangles[t].end(), e.b, middle);
      std::replace(half.begin(), half.end(), e.a, middle);
      walls.triangles.push_back(half);
      auto& side = at[key(e.b, apex)];
      std::replace(side.begin(), side.end(), t, other);
      add(middle, apex, t), add(e.a, middle, t);
      at[key(middle, apex)].push_back(other);
      add(middle, e.b, other);
    }
  }
}

// Finds triangles that cross each other, incrementally.
class Crossings {
 public:
  explicit Crossings(const TriangleMesh& walls) : walls_(walls), at_(walls.vertices.size()) {
    index_.reserve(walls.triangles.size());
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      insert(t);
      changed_.push_back(t);
      for (const auto v : walls.triangles[t]) at_[v].push_back(t);
    }
  }

  // The vertices, ascending, of crossing triangles: among all, or after update(), of pairs with a
  // moved vertex.
  std::vector<std::uint32_t> vertices() const {
    std::vector<std::vector<std::uint32_t>> bad(changed_.size());
    parallel_for(bad.size(), 256, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> near;
      for (std::size_t i = begin; i < end; ++i) {
        const auto t = changed_[i];
        const auto c = corners(walls_, t);
        near.clear();
        index_.find_near_triangle(c[0], c[1], c[2], 0, near);
        for (const auto other : near)
          if (other != t && faces_cross(walls_.triangles[t], c, walls_.triangles[other], corners(walls_, other)))
            for (const auto each : {t, other})
              bad[i].insert(bad[i].end(), walls_.triangles[each].begin(), walls_.triangles[each].end());
      }
    });
    std::vector<std::uint32_t> all;
    for (const auto& some : bad) all.insert(all.end(), some.begin(), some.end());
    return sorted(std::move(all));
  }

  // Updates the triangles at moved vertices.
  void update(const std::vector<std::uint32_t>& vertices) {
    changed_.clear();
    for (const auto v : vertices) changed_.insert(changed_.end(), at_[v].begin(), at_[v].end());
    changed_ = sorted(std::move(changed_));
    for (const auto t : changed_) index_.erase(t), insert(t);
  }

 private:
  static std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> indices) {
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
  }
  void insert(std::uint32_t t) {
    const auto c = corners(walls_, t);
    index_.insert(t, box_of(c[0], c[1], c[2]));
  }

  const TriangleMesh& walls_;
  std::vector<std::vector<std::uint32_t>> at_;  // triangles at each vertex
  std::vector<std::uint32_t> changed_;
  TriangleIndex index_;
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
      for (int octave = 0; octave < o.octaves; ++octave, height *= 0.6, frequency *= 2)
        for (int k = 0; k < 3; ++k)
          offset[i][k] +=
              height * gradient_noise(frequency * (flat[i] - skin.box().lo),
                                      o.seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(octave * 3 + k));
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
