// BindingUpdate of body/binding.h. § 6.5 after a step: closest vertices of nodes near the change,
// then the trees that lost or found a root.
#include <algorithm>
#include <numbers>
#include <queue>
#include <set>
#include <tuple>
#include <unordered_map>

#include "body/binding.h"
#include "body/incremental_cache.h"
#include "body/piece_labels.h"
#include "geometry/bvh.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::uint32_t no_depth = ~0u, none = ~0u;

}  // namespace

class BindingUpdate::Impl {
 public:
  explicit Impl(Body& body)
      : body_(body),
        k_(body.surface),
        b_(body.binding),
        depth_(body.cache->depth),
        unseen_masters_(body.cache->unseen_masters) {
    const std::size_t n = k_.surface_vertex_count();
    b_.master_node.resize(n);
    b_.master.resize(n);
    b_.parent.resize(n);
    depth_.resize(n, no_depth);
  }

  void follow_step(const CrackDelta& delta, NodeId first_new, const std::vector<NodeId>& moved,
                   ClosestVertices closest) {
    first_new_ = first_new;
    moved_ = moved;
    std::erase_if(closest, [&](const auto& c) { return std::binary_search(moved.begin(), moved.end(), c.first); });
    update_closest_of(added_nodes());
    update_closest_of(moved);
    update_closest(closest);
    for (const auto v : delta.removed_surface_vertices) retargeted_.insert(v);
    update_masters();
    update_trees_at_changed_edges(delta);
    offer_to_orphans();
    grow();
  }
  std::vector<SurfaceVertexId> finish() {
    update_closest_of(added_nodes());
    update_unseen_masters();
    update_masters();
    offer_to_orphans();
    grow();
    adopt_unseen_shells();
    return rebound();
  }

 private:
  std::vector<NodeId> added_nodes() const;
  void update_closest(const ClosestVertices& closest);
  void update_closest_of(const std::vector<NodeId>& nodes);
  void update_unseen_masters();
  void update_masters();
  void update_trees_at_changed_edges(const CrackDelta& delta);
  void offer_to_orphans();
  void grow();
  void adopt_unseen_shells();
  std::vector<SurfaceVertexId> rebound();

  using Candidate = std::tuple<std::uint32_t, SurfaceVertexId, SurfaceVertexId>;  // depth, parent, vertex

  std::vector<SurfaceVertexId> around(SurfaceVertexId v) const {
    std::vector<SurfaceVertexId> out;
    k_.surface_neighbors(v, out);
    return out;
  }
  bool is_unseen_master(SurfaceVertexId v) const {
    return std::binary_search(unseen_masters_.begin(), unseen_masters_.end(), v);
  }
  // The node that carried a vertex before the step. To be called before the vertex gets another
  // master.
  NodeId carrier_before(SurfaceVertexId v) const {
    const SurfaceVertexId m = b_.master[v.index()];
    if (!m.valid()) return {};
    const auto at = node_before_.find(m);
    return at == node_before_.end() ? b_.master_node[m.index()] : at->second;
  }
  void set_master(SurfaceVertexId v, SurfaceVertexId master) {
    carrier_before_.try_emplace(v, carrier_before(v));
    b_.master[v.index()] = master;
  }
  void set_node(SurfaceVertexId v, NodeId node) {
    node_before_.try_emplace(v, b_.master_node[v.index()]);
    b_.master_node[v.index()] = node;
  }
  // The depth of slaves of a vertex that has one.
  std::uint32_t depth_below(SurfaceVertexId parent) const { return depth_[parent.index()] + step_from(k_, parent); }
  void orphan(SurfaceVertexId root);
  void dismiss_unseen_master(SurfaceVertexId v);
  void offer(SurfaceVertexId v, std::uint32_t depth, SurfaceVertexId parent) {
    if (std::tie(depth, parent) < std::tie(depth_[v.index()], b_.parent[v.index()])) queue_.push({depth, parent, v});
  }

  Body& body_;
  const Complex& k_;
  Binding& b_;
  std::vector<std::uint32_t>& depth_;
  std::vector<SurfaceVertexId>& unseen_masters_;
  NodeId first_new_;
  std::vector<NodeId> moved_;
  std::set<SurfaceVertexId> retargeted_;  // vertices that became or ceased to be the closest of a node
  std::vector<SurfaceVertexId> orphans_;  // some have a parent again
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  std::unordered_map<SurfaceVertexId, NodeId> node_before_, carrier_before_;
};

namespace {

ClosestVertices closest_vertices(const Body& body, std::span<const NodeId> nodes) {
  ClosestVertices result(nodes.size());
  parallel_for(nodes.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t i = nodes[s].index();
      result[s] = {nodes[s], closest_vertex(body.surface, body.nodes.position[i], body.nodes.radius[i])};
    }
  });
  return result;
}

}  // namespace

// A node's closest vertex v depends on faces within 1.05 |v − x|, since visible_fan() tests points
// up to a twentieth farther. 1.06 covers rounding, too. Without a closest vertex, the node depends
// on all faces within 1.06 support radii.
ClosestVertices closest_after(const Body& body, const CrackDelta& delta) {
  const Complex& k = body.surface;
  const auto& x = body.nodes.position;
  const double reach = longest_reach(body);
  std::vector<std::array<Vec3, 3>> faces;
  for (const FaceId f : delta.new_faces) faces.push_back(k.corners(f));
  const TriangleBvh changed(faces);
  std::vector<NodeId> stale;
  body.cache->grid.walk(
      [&](int, const Vec3& middle, double half) {
        return changed.closest(middle, std::numbers::sqrt3 * half + 1.06 * reach).triangle != none;
      },
      [&](int, std::uint32_t i) { stale.push_back(NodeId(i)); });
  parallel_for(stale.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t i = stale[s].index();
      const auto closest = body.binding.closest[i];
      const double far =
          closest.valid() && k.alive(closest) ? (k.point(k.site(closest)) - x[i]).norm() : body.nodes.radius[i];
      if (changed.closest(x[i], 1.06 * far).triangle == none) stale[s] = NodeId();
    }
  });
  std::erase(stale, NodeId());
  std::sort(stale.begin(), stale.end());
  return closest_vertices(body, stale);
}

// The nodes that `closest` has no entry for yet.
std::vector<NodeId> BindingUpdate::Impl::added_nodes() const {
  std::vector<NodeId> added;
  for (auto i = static_cast<std::uint32_t>(b_.closest.size()); i < body_.nodes.size(); ++i) added.push_back(NodeId(i));
  return added;
}

void BindingUpdate::Impl::update_closest(const ClosestVertices& closest) {
  b_.closest.resize(body_.nodes.size());
  for (const auto& [node, now] : closest) {
    auto& before = b_.closest[node.index()];
    const bool elsewhere = node >= first_new_ || std::binary_search(moved_.begin(), moved_.end(), node);
    if (before == now && !elsewhere) continue;
    for (const auto v : {before, now})
      if (v.valid()) retargeted_.insert(v);
    before = now;
  }
}

void BindingUpdate::Impl::update_closest_of(const std::vector<NodeId>& nodes) {
  update_closest(closest_vertices(body_, nodes));
}

// The node that carries an unseen shell v changes in three cases: it moved, it is in another piece
// now, or a new or moved node is at most as far from v.
void BindingUpdate::Impl::update_unseen_masters() {
  const auto before = unseen_masters_;
  for (const auto v : before) {
    bool stays = k_.alive(v);
    if (stays) {
      const NodeId node = b_.master_node[v.index()];
      const Vec3& q = k_.point(k_.site(v));
      const double d = (body_.nodes.position[node.index()] - q).squaredNorm();
      const auto rivals = [&](NodeId i) { return (body_.nodes.position[i.index()] - q).squaredNorm() <= d; };
      stays = !std::binary_search(moved_.begin(), moved_.end(), node) &&
              std::none_of(moved_.begin(), moved_.end(), rivals) &&
              (body_.cache->pieces_without_node.count(body_.cache->piece[v.index()]) ||
               piece_of(body_, node) == body_.cache->piece[v.index()]);
      for (std::uint32_t i = first_new_.value; i < body_.nodes.size() && stays; ++i) stays = !rivals(NodeId(i));
    }
    if (!stays) dismiss_unseen_master(v);
  }
}

void BindingUpdate::Impl::dismiss_unseen_master(SurfaceVertexId v) {
  set_node(v, NodeId());
  unseen_masters_.erase(std::lower_bound(unseen_masters_.begin(), unseen_masters_.end(), v));
  orphan(v);
}

void BindingUpdate::Impl::update_masters() {
  const std::vector<SurfaceVertexId> vertices(retargeted_.begin(), retargeted_.end());
  std::vector<NodeId> nodes(vertices.size());
  parallel_for(vertices.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (k_.alive(vertices[k])) nodes[k] = master_node_of(body_, b_, vertices[k]);
  });
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const auto v = vertices[k];
    if (k_.alive(v) && b_.master[v.index()].valid() && is_unseen_master(b_.master[v.index()]))
      dismiss_unseen_master(b_.master[v.index()]);
    const NodeId node = nodes[k], before = b_.master_node[v.index()];
    if (node != before) set_node(v, node);
    if (!k_.alive(v) || (before.valid() && !node.valid()))
      orphan(v);
    else if (node.valid() && !before.valid())
      offer(v, 0, v);
  }
  retargeted_.clear();
}

// The whole subtree loses its master. Vertices that are no longer beside their parents are found
// one by one.
void BindingUpdate::Impl::orphan(SurfaceVertexId root) {
  std::vector<SurfaceVertexId> tree{root};
  while (!tree.empty()) {
    const auto v = tree.back();
    tree.pop_back();
    if (k_.alive(v)) {
      orphans_.push_back(v);
      for (const auto w : around(v))
        if (b_.parent[w.index()] == v && w != v) tree.push_back(w);
    }
    set_master(v, SurfaceVertexId());
    b_.parent[v.index()] = SurfaceVertexId();
    depth_[v.index()] = no_depth;
  }
}

// Edges of the surface come and go only at vertices of the delta.
void BindingUpdate::Impl::update_trees_at_changed_edges(const CrackDelta& delta) {
  auto at = delta.touched_surface_vertices;
  at.insert(at.end(), delta.new_surface_vertices.begin(), delta.new_surface_vertices.end());
  std::vector<SurfaceVertexId> seen = at;
  for (const auto v : at)
    for (const auto w : around(v)) seen.push_back(w);
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  for (const auto v : seen) {
    const auto beside = around(v);
    const auto parent = b_.parent[v.index()], master = b_.master[v.index()];
    // The parent is elsewhere, or has come to a border, or left it.
    if (parent.valid() && parent != v &&
        (!std::binary_search(beside.begin(), beside.end(), parent) || depth_[v.index()] != depth_below(parent)))
      orphan(v);
    // An unseen shell may have joined another one.
    if (b_.master[v.index()].valid() && is_unseen_master(master)) dismiss_unseen_master(master);
  }
  orphans_.insert(orphans_.end(), delta.new_surface_vertices.begin(), delta.new_surface_vertices.end());
  for (const auto v : at)
    for (const auto w : around(v)) {
      if (depth_[w.index()] != no_depth) offer(v, depth_below(w), w);
      if (depth_[v.index()] != no_depth) offer(w, depth_below(v), v);
    }
}

// Neighbours of orphans may become their parents.
void BindingUpdate::Impl::offer_to_orphans() {
  std::sort(orphans_.begin(), orphans_.end());
  orphans_.erase(std::unique(orphans_.begin(), orphans_.end()), orphans_.end());
  for (const auto v : orphans_) {
    if (!k_.alive(v) || depth_[v.index()] != no_depth) continue;
    for (const auto w : around(v))
      if (depth_[w.index()] != no_depth) offer(v, depth_below(w), w);
  }
}

// Dijkstra's algorithm on (depth, parent): orphans get the least depth and, among equals, the
// lowest parent. Then masters are passed down the trees whose roots changed.
void BindingUpdate::Impl::grow() {
  std::priority_queue<std::pair<std::uint32_t, SurfaceVertexId>, std::vector<std::pair<std::uint32_t, SurfaceVertexId>>,
                      std::greater<>>
      changed;
  while (!queue_.empty()) {
    const auto [depth, parent, v] = queue_.top();
    queue_.pop();
    if (std::tie(depth_[v.index()], b_.parent[v.index()]) <= std::tie(depth, parent)) continue;
    depth_[v.index()] = depth;
    b_.parent[v.index()] = parent;
    changed.push({depth, v});
    const std::uint32_t below = depth_below(v);
    for (const auto w : around(v)) offer(w, below, v);
  }
  while (!changed.empty()) {
    const auto [depth, v] = changed.top();
    changed.pop();
    const auto master = depth == 0 ? v : b_.master[b_.parent[v.index()].index()];
    if (depth != depth_[v.index()] || master == b_.master[v.index()]) continue;
    set_master(v, master);
    const std::uint32_t below = depth_below(v);
    for (const auto w : around(v))
      if (b_.parent[w.index()] == v && w != v) changed.push({below, w});
  }
}

// Shells that no master reached, the lowest vertex of each first.
void BindingUpdate::Impl::adopt_unseen_shells() {
  for (const auto v : orphans_) {
    if (!k_.alive(v) || depth_[v.index()] != no_depth) continue;
    const auto piece = body_.cache->piece[v.index()];
    NodeId node;
    if (!body_.cache->pieces_without_node.count(piece))
      node = carrier_of_unseen_shell(body_, v, [&](NodeId i) { return piece_of(body_, i) == piece; });
    if (!node.valid()) {
      body_.cache->pieces_without_node.insert(piece);
      node = carrier_of_unseen_shell(body_, v, [](NodeId) { return true; });
    }
    set_node(v, node);
    unseen_masters_.insert(std::lower_bound(unseen_masters_.begin(), unseen_masters_.end(), v), v);
    offer(v, 0, v);
    grow();
  }
}

std::vector<SurfaceVertexId> BindingUpdate::Impl::rebound() {
  // Whole trees whose root has another carrying node.
  for (const auto& [root, node] : node_before_) {
    if (!k_.alive(root) || b_.master[root.index()] != root || b_.master_node[root.index()] == node) continue;
    std::vector<SurfaceVertexId> tree{root};
    while (!tree.empty()) {
      const auto v = tree.back();
      tree.pop_back();
      carrier_before_.try_emplace(v, node);
      for (const auto w : around(v))
        if (b_.parent[w.index()] == v && w != v) tree.push_back(w);
    }
  }
  std::vector<SurfaceVertexId> out;
  for (const auto& [v, before] : carrier_before_) {
    const auto master = b_.master[v.index()];
    if (k_.alive(v) && (master.valid() ? b_.master_node[master.index()] : NodeId()) != before) out.push_back(v);
  }
  std::sort(out.begin(), out.end());
  return out;
}

BindingUpdate::BindingUpdate(Body& body) : impl_(std::make_unique<Impl>(body)) {}
BindingUpdate::~BindingUpdate() = default;

void BindingUpdate::follow_step(const CrackDelta& delta, NodeId first_new, const std::vector<NodeId>& moved,
                                ClosestVertices closest) {
  impl_->follow_step(delta, first_new, moved, std::move(closest));
}

std::vector<SurfaceVertexId> BindingUpdate::finish() { return impl_->finish(); }

}  // namespace geo
