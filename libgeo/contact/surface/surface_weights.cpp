// Eq. 1: u(x) = Σ_i w_i (u_i + ∇u_i (x − x_i)), w_i = W_i / Σ W. With ∇u_i = Σ_j u_j ⊗ g_ij, the
// weight of u_i is w_i, and that of each u_j gains w_i g_ij · (x − x_i).
#include "contact/surface/surface_weights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>

#include "body/binding.h"
#include "contact/surface/contact_surface.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/solver/solid_discretisation.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {
namespace {

// Sums weights by node. All sums are zero between stencils, so that the cost follows the stencil.
class StencilSums {
 public:
  // For this number of nodes.
  void resize(std::size_t nodes) {
    weight_.resize(std::max(weight_.size(), nodes), 0);
    used_.resize(std::max(used_.size(), (nodes + 63) / 64), 0);
    // A stencil was abandoned if memory for it could not be allocated.
    if (std::any_of(used_.begin(), used_.end(), [](auto bits) { return bits != 0; })) {
      std::fill(used_.begin(), used_.end(), 0);
      std::fill(weight_.begin(), weight_.end(), 0.0);
    }
    start();
  }
  void add(std::uint32_t j, double w) {
    const std::size_t word = j / 64;
    low_ = std::min(low_, word);
    high_ = std::max(high_, word);
    used_[word] |= std::uint64_t(1) << j % 64;
    weight_[j] += w;
  }
  // Writes the sums to an empty stencil, by ascending nodes, without zeros, and starts the next
  // one.
  void move_to(std::vector<NodeWeight>& stencil) {
    std::size_t size = 0;
    for (auto word = low_; word <= high_; ++word) size += static_cast<std::size_t>(std::popcount(used_[word]));
    stencil.reserve(size);
    for (auto word = low_; word <= high_; ++word)
      for (auto& bits = used_[word]; bits != 0; bits &= bits - 1) {
        const auto j = static_cast<std::uint32_t>(64 * word + static_cast<std::size_t>(std::countr_zero(bits)));
        if (weight_[j] != 0) stencil.push_back({j, weight_[j]});
        weight_[j] = 0;
      }
    start();
  }

 private:
  void start() {
    low_ = used_.size();
    high_ = 0;
  }

  std::vector<double> weight_;       // per node
  std::vector<std::uint64_t> used_;  // one bit a node
  std::size_t low_ = 0, high_ = 0;   // range of words in use
};

}  // namespace

void SurfaceWeights::rebuild(const Body& body, const Solid& solid) {
  stencils_.clear();
  heaviest_.clear();
  rest_.clear();
  norm_.clear();
  area_.clear();
  arms_.clear();
  masters_.clear();
  changed_.clear();
  resolution_ = Resolution(body.surface.extent().diagonal());
  std::vector<std::uint32_t> all(body.surface.surface_vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  compute(body, solid, all);
  rotated_.clear();
}

void SurfaceWeights::mark_changed(const Body& body, const BodyDelta& delta) {
  // A stencil depends on the neighbours of the vertex' nodes and of their neighbours.
  std::vector<std::uint8_t> stale_node(body.nodes.size(), 0);
  for (const NodeId i : delta.updated_nodes) {
    stale_node[i.index()] = 1;
    for (const auto& n : body.graph.neighbors(body.nodes, i)) stale_node[n.to.index()] = 1;
  }
  const std::size_t n = body.surface.surface_vertex_count();
  changed_.resize(n, 0);
  std::vector<SurfaceVertexId> around;
  for (const auto v : delta.rebound_vertices) {
    changed_[v.index()] = 1;
    // Borders take the nodes of vertices beside them.
    around.clear();
    if (body.surface.alive(v)) body.surface.surface_neighbors(v, around);
    for (const auto w : around)
      if (is_on_border(body.surface, w)) changed_[w.index()] = 1;
  }
  const CrackDelta& crack = delta.crack;
  for (const auto* some :
       {&crack.new_surface_vertices, &crack.touched_surface_vertices, &crack.removed_surface_vertices})
    for (const auto v : *some) changed_[v.index()] = 1;
  parallel_for(n, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::array<NodeId, 2> of = v < masters_.size() ? masters_[v] : std::array<NodeId, 2>{};
      changed_[v] =
          changed_[v] || !of[0].valid() || stale_node[of[0].index()] || (of[1].valid() && stale_node[of[1].index()]);
    }
  });
}

std::vector<std::uint32_t> SurfaceWeights::update(const Body& body, const Solid& solid) {
  std::vector<std::uint32_t> vertices;
  if (!has_changes()) return vertices;
  for (std::uint32_t v = 0; v < changed_.size(); ++v)
    if (changed_[v]) vertices.push_back(v);
  changed_.clear();
  compute(body, solid, vertices);
  return vertices;
}

bool SurfaceWeights::set_rotations(const Solid& solid, const std::vector<Vec3>& u) {
  const NodalGradientOperator& mls = SolidDiscretisation::of(solid).mls;
  std::vector<std::uint32_t> rotating;
  std::vector<char> is_rotating(mls.size(), 0);
  for (const auto& arms : arms_)
    for (const Arm& a : arms)
      if (a.share < 1 && !is_rotating[a.node]) {
        is_rotating[a.node] = 1;
        rotating.push_back(a.node);
      }
  std::vector<Mat3> rotation(rotating.empty() ? 0 : mls.size());  // of these nodes
  parallel_for(rotating.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) rotation[rotating[k]] = mls.rotation(rotating[k], u);
  });
  std::vector<Vec3> rotated;
  if (!rotating.empty() || mls.has_rotations()) {
    rotated.resize(arms_.size(), Vec3::Zero());
    for (std::size_t v = 0; v < arms_.size(); ++v)
      for (const Arm& a : arms_[v]) {
        Mat3 motion = a.share * mls.undetermined(a.node);
        if (a.share < 1) motion += (1 - a.share) * (rotation[a.node] - Mat3::Identity());
        rotated[v] += motion * a.arm;
      }
  }
  if (rotated == rotated_) return false;
  rotated_ = std::move(rotated);
  return true;
}

std::vector<Vec3> SurfaceWeights::interpolate(std::span<const std::uint32_t> vertices,
                                              const std::vector<Vec3>& values) const {
  std::vector<Vec3> result(vertices.size());
  for_each_weighted_sum(
      vertices.size(), values, [&](std::size_t k) { return stencil(vertices[k]); },
      [&](std::size_t k, const Vec3& sum) { result[k] = sum; });
  return result;
}

void SurfaceWeights::compute(const Body& body, const Solid& solid, std::span<const std::uint32_t> vertices) {
  const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  stencils_.resize(body.surface.surface_vertex_count());
  heaviest_.resize(stencils_.size(), ~0u);
  norm_.resize(stencils_.size(), 0);
  area_.resize(stencils_.size(), 0);
  arms_.resize(stencils_.size());
  masters_.resize(stencils_.size());
  rest_.resize(stencils_.size(), none);
  if (!rotated_.empty()) rotated_.resize(stencils_.size(), Vec3::Zero());
  const NodalGradientOperator& mls = SolidDiscretisation::of(solid).mls;
  parallel_for(vertices.size(), 128, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> bound;
    thread_local StencilSums sums;  // as large as all nodes, for a range of few vertices
    sums.resize(solid.size());
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t v = vertices[k];
      const SurfaceVertexId id(v);
      auto& stencil = stencils_[v];
      stencil.clear();
      heaviest_[v] = ~0u;
      norm_[v] = area_[v] = 0;
      arms_[v].clear();
      masters_[v] = {};
      rest_[v] = none;
      if (!body.surface.alive(id)) continue;
      const Vec3& x = rest_[v] = body.surface.point(body.surface.site(id));
      area_[v] = vertex_area(body.surface, id);
      masters_[v] = master_nodes(body, id);
      carriers_beside(body, id, masters_[v], bound);
      if (bound.empty()) continue;
      // Kernel weights replace distances. If all vanish, the first node carries the vertex.
      double total = 0;
      for (auto& [i, d] : bound) total += d = kernel(d / body.nodes.radius[i.index()], 1.0);
      if (!(total > 0)) {
        bound.resize(1);
        bound[0].second = total = 1;
      }
      const auto arm_of = [&](NodeId i, double w) -> Vec3 { return w / total * (x - body.nodes.position[i.index()]); };
      double amplified = 0;
      for (const auto& [i, w] : bound)
        if (w > 0) amplified += mls.amplification(i.index(), arm_of(i, w));
      const double share = gradient_share(amplified);
      for (const auto& [i, w] : bound) {
        const NodalGradientOperator::Node& node = mls[i.index()];
        const Vec3 arm = arm_of(i, w);
        sums.add(i.value, w / total + share * node.own_gradient.dot(arm));
        if (node.quality != MomentQuality::good || share < 1) arms_[v].push_back({i.value, arm, share});
        if (w == 0) continue;
        for (std::size_t q = 0; q < node.neighbors.size(); ++q)
          sums.add(node.neighbors[q], share * node.gradient[q].dot(arm));
      }
      sums.move_to(stencil);
      const auto heaviest = std::max_element(stencil.begin(), stencil.end(),
                                             [](const Entry& a, const Entry& b) { return a.weight < b.weight; });
      if (heaviest != stencil.end()) heaviest_[v] = heaviest->node;
      norm_[v] = weight_norm(stencil);
    }
  });
}

}  // namespace geo
