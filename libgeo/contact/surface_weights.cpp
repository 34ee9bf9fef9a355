#include "contact/surface_weights.h"

#include <algorithm>

#include "base/parallel.h"
#include "mechanics/kernel.h"

namespace geo {

void SurfaceWeights::update(const Body& body, const Solid& solid) {
  const std::size_t n = body.surface.surface_vertex_count();
  rows_.resize(n);
  heaviest_.assign(n, ~0u);
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> bound;
    std::vector<std::pair<NodeId, Vec3>> gradient;
    std::vector<double> weight(solid.size(), 0);
    std::vector<std::uint32_t> used;
    for (std::size_t v = begin; v < end; ++v) {
      const SurfaceVertexId id(v);
      rows_[v].clear();
      if (!body.surface.alive(id)) continue;
      bound_nodes(body, id, bound);
      if (bound.empty()) continue;
      const Vec3& x = body.surface.point(body.surface.site(id));
      double total = 0;
      for (auto& [i, d] : bound) total += d = kernel(d / body.nodes.radius[i.index()], 1.0);
      if (!(total > 0)) bound.resize(1), bound[0].second = total = 1;
      const auto add = [&](NodeId j, double w) {
        if (weight[j.index()] == 0) used.push_back(j.value);
        weight[j.index()] += w;
      };
      used.clear();
      for (const auto& [i, w] : bound) {
        add(i, w / total);
        gradient.clear();
        solid.gradient_row(i, gradient);
        for (const auto& [j, g] : gradient) add(j, w / total * g.dot(x - body.nodes.position[i.index()]));
      }
      std::sort(used.begin(), used.end());
      for (const auto j : used) {
        if (weight[j] != 0) rows_[v].push_back({j, weight[j]});
        weight[j] = 0;
      }
      const auto most = std::max_element(rows_[v].begin(), rows_[v].end(), [](const Entry& a, const Entry& b) { return a.weight < b.weight; });
      if (most != rows_[v].end()) heaviest_[v] = most->node;
    }
  });
}

}  // namespace geo
