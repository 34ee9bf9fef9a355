#include "contact/surface/surface_weights.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "contact/surface/contact_surface.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {

void SurfaceWeights::update(const Body& body, const Solid& solid) {
  rows_.clear(), heaviest_.clear(), spread_.clear(), area_.clear();
  std::vector<std::uint32_t> all(body.surface.surface_vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  make(body, solid, all);
}

std::vector<std::uint32_t> SurfaceWeights::follow(const Body& body, const Solid& solid, const BodyDelta& delta) {
  // A row is of what the vertex's node and its neighbours have as neighbours.
  std::vector<std::uint8_t> stale(body.nodes.size(), 0);
  for (const NodeId i : delta.updated_nodes) {
    stale[i.index()] = 1;
    for (const auto& n : body.graph.neighbors(body.nodes, i)) stale[n.to.index()] = 1;
  }
  const std::size_t n = body.surface.surface_vertex_count();
  std::vector<std::uint8_t> asked(n, 0);
  for (const auto v : delta.rebound_vertices) asked[v.index()] = 1;
  for (const auto* some : {&delta.crack.new_surface_vertices, &delta.crack.touched_surface_vertices})
    for (const auto v : *some) asked[v.index()] = 1;
  parallel_for(n, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const SurfaceVertexId master =
          body.surface.alive(SurfaceVertexId(v)) ? body.binding.master[v] : SurfaceVertexId();
      asked[v] = asked[v] || !master.valid() || stale[body.binding.master_node[master.index()].index()];
    }
  });
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < n; ++v)
    if (asked[v]) vertices.push_back(v);
  make(body, solid, vertices);
  return vertices;
}

std::vector<Vec3> SurfaceWeights::at_each(std::span<const std::uint32_t> vertices,
                                          const std::vector<Vec3>& values) const {
  std::vector<Vec3> result(vertices.size());
  for_each_weighted_sum(
      vertices.size(), values, [&](std::size_t k) { return row(vertices[k]); },
      [&](std::size_t k, const Vec3& sum) { result[k] = sum; });
  return result;
}

void SurfaceWeights::make(const Body& body, const Solid& solid, std::span<const std::uint32_t> vertices) {
  rows_.resize(body.surface.surface_vertex_count());
  heaviest_.resize(rows_.size(), ~0u), spread_.resize(rows_.size(), 0), area_.resize(rows_.size(), 0);
  parallel_for(vertices.size(), 128, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> bound;
    std::vector<std::pair<NodeId, Vec3>> gradient;
    // Of all nodes, zero between rows: each thread keeps its own, as there are few vertices to a
    // range.
    thread_local std::vector<double> weight;
    thread_local std::vector<std::uint64_t> used;  // a bit a node
    weight.resize(std::max(weight.size(), solid.size()), 0),
        used.resize(std::max(used.size(), (solid.size() + 63) / 64), 0);
    if (std::any_of(used.begin(), used.end(),
                    [](auto bits) { return bits != 0; }))  // a row was given up when there was no memory for it
      std::fill(used.begin(), used.end(), 0), std::fill(weight.begin(), weight.end(), 0.0);
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t v = vertices[k];
      const SurfaceVertexId id(v);
      rows_[v].clear(), heaviest_[v] = ~0u, spread_[v] = area_[v] = 0;
      if (!body.surface.alive(id)) continue;
      area_[v] = area_about(body.surface, id);
      carrier_nodes(body, id, bound);
      if (bound.empty()) continue;
      const Vec3& x = body.surface.point(body.surface.site(id));
      double total = 0;
      for (auto& [i, d] : bound) total += d = kernel(d / body.nodes.radius[i.index()], 1.0);
      if (!(total > 0)) bound.resize(1), bound[0].second = total = 1;
      std::size_t low = used.size(), high = 0, size = 0;
      const auto add = [&](NodeId j, double w) {
        const std::size_t word = j.index() / 64;
        const std::uint64_t bit = std::uint64_t(1) << j.index() % 64;
        low = std::min(low, word), high = std::max(high, word);
        size += (used[word] & bit) == 0;
        used[word] |= bit;
        weight[j.index()] += w;
      };
      for (const auto& [i, w] : bound) {
        add(i, w / total);
        gradient.clear();
        solid.gradient_row(i, gradient);
        for (const auto& [j, g] : gradient) add(j, w / total * g.dot(x - body.nodes.position[i.index()]));
      }
      rows_[v].reserve(size);
      for (auto word = low; word <= high; ++word)
        for (auto& bits = used[word]; bits != 0; bits &= bits - 1) {
          const auto j = static_cast<std::uint32_t>(64 * word + static_cast<std::size_t>(std::countr_zero(bits)));
          if (weight[j] != 0) rows_[v].push_back({j, weight[j]});
          weight[j] = 0;
        }
      const auto most = std::max_element(rows_[v].begin(), rows_[v].end(),
                                         [](const Entry& a, const Entry& b) { return a.weight < b.weight; });
      if (most != rows_[v].end()) heaviest_[v] = most->node;
      spread_[v] = weight_norm(rows_[v]);
    }
  });
}

}  // namespace geo
