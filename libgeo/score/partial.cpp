#include "score/partial.h"

#include <algorithm>
#include <limits>
#include <map>

#include "base/union_find.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr double whole = std::numeric_limits<double>::infinity();

struct Edge {
  std::vector<std::uint32_t> triangles;
  struct Split {
    double level;
    std::uint32_t row;
  };
  std::vector<Split> splits;  // from the lower row to the higher one
};

class Rim {
 public:
  Rim(TriangleMesh& walls, const TriangleBvh& skin, double depth)
      : walls_(walls), level_(walls.triangles.size(), whole) {
    find_depths(skin);
    for (std::uint32_t t = 0; t < walls_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) edge(t, k).triangles.push_back(t);
    find_levels(skin, depth);
  }

  // Cuts triangles along their walls' levels, those beside them in the same points.
  void cut() {
    for (auto& [name, e] : edges_) split(e, static_cast<std::uint32_t>(name >> 32), static_cast<std::uint32_t>(name));
    std::vector<Triangle> kept;
    for (std::uint32_t t = 0; t < level_.size(); ++t) {
      const auto loop = shallow(t);
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
  double deepest_of(std::uint32_t t) const {
    const auto& c = walls_.triangles[t];
    return std::max({deep_[c[0]], deep_[c[1]], deep_[c[2]]});
  }

  void find_depths(const TriangleBvh& skin) {
    deep_.resize(walls_.vertices.size());
    parallel_for(deep_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3& p = walls_.vertices[v];
        deep_[v] = skin.closest(p).distance * (skin.inside(p) ? 1 : -1);
      }
    });
  }

  // Triangles that meet in the material across an edge which no other wall has belong together: one
  // level for all.
  void find_levels(const TriangleBvh& skin, double depth) {
    UnionFind joined(level_.size());
    for (const auto& [name, e] : edges_)
      if (e.triangles.size() == 2 && std::max(deep_[name >> 32], deep_[static_cast<std::uint32_t>(name)]) > 0)
        joined.unite(e.triangles[0], e.triangles[1]);
    std::vector<double> deepest(level_.size(), 0);
    for (std::uint32_t t = 0; t < level_.size(); ++t)
      deepest[joined.find(t)] = std::max(deepest[joined.find(t)], deepest_of(t));
    for (std::uint32_t t = 0; t < level_.size(); ++t) {
      const auto& c = walls_.triangles[t];
      if (deepest_of(t) > 0)
        level_[t] = depth * deepest[joined.find(t)];
      else if (skin.inside((walls_.vertices[c[0]] + walls_.vertices[c[1]] + walls_.vertices[c[2]]) / 3))
        level_[t] = -whole;  // all of a thin place
    }
  }

  // Where levels of the walls at an edge cross it; at its end where that is nearer than a
  // twentieth.
  void split(Edge& e, std::uint32_t a, std::uint32_t b) {
    for (const auto t : e.triangles) {
      const double level = level_[t];
      if ((deep_[a] < level) == (deep_[b] < level) ||
          std::any_of(e.splits.begin(), e.splits.end(), [&](const auto& s) { return s.level == level; }))
        continue;
      const double s = (level - deep_[a]) / (deep_[b] - deep_[a]);
      if (s < 0.05 || s > 0.95) {
        e.splits.push_back({level, s < 0.5 ? a : b});
        continue;
      }
      e.splits.push_back({level, static_cast<std::uint32_t>(walls_.vertices.size())});
      walls_.vertices.push_back(walls_.vertices[a] + s * (walls_.vertices[b] - walls_.vertices[a]));
    }
    const bool down = deep_[a] < deep_[b];
    std::sort(e.splits.begin(), e.splits.end(),
              [&](const auto& x, const auto& y) { return down ? x.level < y.level : x.level > y.level; });
  }

  // The loop around what of a triangle is less deep than its level.
  std::vector<std::uint32_t> shallow(std::uint32_t t) {
    std::vector<std::uint32_t> loop;
    const auto add = [&](std::uint32_t v) {
      if (std::find(loop.begin(), loop.end(), v) == loop.end()) loop.push_back(v);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = walls_.triangles[t][k], b = walls_.triangles[t][(k + 1) % 3];
      if (deep_[a] < level_[t]) add(a);
      auto splits = edge(t, k).splits;
      if (a > b) std::reverse(splits.begin(), splits.end());
      for (const auto& s : splits)
        if (s.level <= level_[t]) add(s.row);
    }
    return loop;
  }

  TriangleMesh& walls_;
  std::vector<double> deep_;   // per row as it was: below the skin; negative outside
  std::vector<double> level_;  // per triangle: how deep it may go
  std::map<std::uint64_t, Edge> edges_;
};

}  // namespace

void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth) {
  if (!(depth > 0 && depth < 1)) throw InputError("the depth of a partial score must be above 0 and below 100 percent");
  Rim(walls, skin, depth).cut();
}

}  // namespace geo
