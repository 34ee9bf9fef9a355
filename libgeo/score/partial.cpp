// Depth is the distance to the skin, negative outside, at the vertices of the walls. A connected
// part keeps what is less deep than the fraction of its greatest depth. Triangles are cut along
// that level of the linearly interpolated depth (as marching triangles do).
#include "score/partial.h"

#include <algorithm>
#include <limits>
#include <map>

#include "base/union_find.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

// An edge of the walls, and where the levels of its triangles cross it. A level is the greatest
// depth that is kept.
struct Edge {
  std::vector<std::uint32_t> triangles;
  struct Split {
    double level;
    std::uint32_t vertex;
  };
  std::vector<Split> splits;  // from the lower vertex to the higher one
};

// Cuts walls at a level of depth of their own each.
class LevelCut {
 public:
  LevelCut(TriangleMesh& walls, const TriangleBvh& skin, double depth)
      : walls_(walls), level_(walls.triangles.size(), unlimited) {
    find_depths(skin);
    for (std::uint32_t t = 0; t < walls_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) edge(t, k).triangles.push_back(t);
    find_levels(skin, depth);
  }

  // Cuts triangles along the levels of their walls; neighbours share the points.
  void cut() {
    for (auto& [name, e] : edges_) split(e, static_cast<std::uint32_t>(name >> 32), static_cast<std::uint32_t>(name));
    std::vector<Triangle> kept;
    for (std::uint32_t t = 0; t < level_.size(); ++t) {
      const auto loop = shallow_part(t);
      if (loop.size() < 3) continue;
      if (loop.size() == 3) {
        kept.push_back({loop[0], loop[1], loop[2]});
        continue;
      }
      Vec3 middle = Vec3::Zero();
      for (const auto v : loop) middle += walls_.vertices[v] / double(loop.size());
      const auto center = static_cast<std::uint32_t>(walls_.vertices.size());
      walls_.vertices.push_back(middle);
      for (std::size_t i = 0; i < loop.size(); ++i) kept.push_back({loop[i], loop[(i + 1) % loop.size()], center});
    }
    walls_.triangles = std::move(kept);
  }

 private:
  Edge& edge(std::uint32_t t, std::size_t k) {
    const auto a = walls_.triangles[t][k], b = walls_.triangles[t][(k + 1) % 3];
    return edges_[std::uint64_t(std::min(a, b)) << 32 | std::max(a, b)];
  }
  double greatest_depth(std::uint32_t t) const {
    const auto& c = walls_.triangles[t];
    return std::max({depth_[c[0]], depth_[c[1]], depth_[c[2]]});
  }

  void find_depths(const TriangleBvh& skin) {
    depth_.resize(walls_.vertices.size());
    parallel_for(depth_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3& p = walls_.vertices[v];
        depth_[v] = skin.closest(p).distance * (skin.inside(p) ? 1 : -1);
      }
    });
  }

  // Triangles connected inside the material, across edges that no other wall has, get one level.
  void find_levels(const TriangleBvh& skin, double depth) {
    UnionFind joined(level_.size());
    for (const auto& [name, e] : edges_)
      if (e.triangles.size() == 2 && std::max(depth_[name >> 32], depth_[static_cast<std::uint32_t>(name)]) > 0)
        joined.unite(e.triangles[0], e.triangles[1]);
    std::vector<double> deepest(level_.size(), 0);
    for (std::uint32_t t = 0; t < level_.size(); ++t)
      deepest[joined.find(t)] = std::max(deepest[joined.find(t)], greatest_depth(t));
    for (std::uint32_t t = 0; t < level_.size(); ++t) {
      const auto& c = walls_.triangles[t];
      if (greatest_depth(t) > 0)
        level_[t] = depth * deepest[joined.find(t)];
      else if (skin.inside((walls_.vertices[c[0]] + walls_.vertices[c[1]] + walls_.vertices[c[2]]) / 3))
        level_[t] = -unlimited;  // thinner than a triangle: dropped
    }
  }

  // Adds the points s = (level − d_a) / (d_b − d_a) where levels of the triangles at an edge cross
  // it. An end nearer than a twentieth of the edge is used instead: no needles there.
  void split(Edge& e, std::uint32_t a, std::uint32_t b) {
    for (const auto t : e.triangles) {
      const double level = level_[t];
      if ((depth_[a] < level) == (depth_[b] < level) ||
          std::any_of(e.splits.begin(), e.splits.end(), [&](const auto& s) { return s.level == level; }))
        continue;
      const double s = (level - depth_[a]) / (depth_[b] - depth_[a]);
      if (s < 0.05 || s > 0.95) {
        e.splits.push_back({level, s < 0.5 ? a : b});
        continue;
      }
      e.splits.push_back({level, static_cast<std::uint32_t>(walls_.vertices.size())});
      walls_.vertices.push_back(walls_.vertices[a] + s * (walls_.vertices[b] - walls_.vertices[a]));
    }
    const bool down = depth_[a] < depth_[b];
    std::sort(e.splits.begin(), e.splits.end(),
              [&](const auto& x, const auto& y) { return down ? x.level < y.level : x.level > y.level; });
  }

  // The polygon of a triangle that is less deep than its level.
  std::vector<std::uint32_t> shallow_part(std::uint32_t t) {
    std::vector<std::uint32_t> loop;
    const auto add = [&](std::uint32_t v) {
      if (std::find(loop.begin(), loop.end(), v) == loop.end()) loop.push_back(v);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = walls_.triangles[t][k], b = walls_.triangles[t][(k + 1) % 3];
      if (depth_[a] < level_[t]) add(a);
      auto splits = edge(t, k).splits;
      if (a > b) std::reverse(splits.begin(), splits.end());
      for (const auto& s : splits)
        if (s.level <= level_[t]) add(s.vertex);
    }
    return loop;
  }

  TriangleMesh& walls_;
  std::vector<double> depth_;  // per original vertex: depth below the skin, negative outside
  std::vector<double> level_;  // per triangle: the greatest depth that is kept
  std::map<std::uint64_t, Edge> edges_;
};

}  // namespace

void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth) {
  if (!(depth > 0 && depth < 1)) throw InputError("the depth of a partial score must be above 0 and below 100 percent");
  LevelCut(walls, skin, depth).cut();
}

}  // namespace geo
