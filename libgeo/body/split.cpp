// The seven steps of § 4, one call a line.
#include <algorithm>
#include <chrono>
#include <set>

#include "body/binding.h"
#include "body/locate.h"
#include "body/nodes.h"

namespace geo {
namespace {

double since(std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last).count();
  last = now;
  return seconds;
}

// Closest vertices anew for nodes that see the change, then the trees.
void rebind(Body& body, const CrackDelta& delta, NodeId first_new, const std::vector<NodeId>& moved,
            std::vector<SurfaceVertexId>& rebound) {
  const Binding before = body.binding;
  body.binding.closest.resize(body.nodes.size());
  std::set<std::uint32_t> stale;
  std::vector<std::uint32_t> near;
  const double reach = body.graph.plain_unit() * 0x1p26;  // no support radius is larger
  for (const FaceId f : delta.new_faces) {
    const auto t = body.surface.corners(f);
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    const double size = std::max({(t[0] - middle).norm(), (t[1] - middle).norm(), (t[2] - middle).norm()});
    near.clear();
    body.grid.within(body.nodes.position, middle, size + reach, near);
    stale.insert(near.begin(), near.end());
  }
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) stale.insert(i);
  for (const NodeId i : moved) stale.insert(i.value);
  for (const auto i : stale)
    body.binding.closest[i] = closest_vertex(body.surface, body.nodes.position[i], body.nodes.radius[i]);
  grow_trees(body);
  const auto node_of = [](const Binding& b, std::size_t v) {
    return v < b.master.size() && b.master[v].valid() ? b.master_node[b.master[v].index()] : NodeId();
  };
  for (std::uint32_t v = 0; v < body.binding.master.size(); ++v)
    if (body.surface.alive(SurfaceVertexId(v)) && node_of(before, v) != node_of(body.binding, v))
      rebound.push_back(SurfaceVertexId(v));
}

BodyDelta follow_delta(Body& body, CrackDelta crack, SplitWork* work) {
  auto clock = std::chrono::steady_clock::now();
  BodyDelta delta;
  delta.crack = std::move(crack);
  delta.first_new_node = NodeId(body.nodes.size());
  body.donors.clear();
  if (delta.crack.empty()) return delta;
  std::vector<std::array<Vec3, 3>> faces;
  for (const FaceId f : delta.crack.new_faces) faces.push_back(body.surface.corners(f));
  const auto near = [&](const Box3& box, std::vector<std::array<Vec3, 3>>& out) {
    triangles_near(body.surface, box, out);
  };

  delta.moved_nodes = move_off(body, delta.crack.new_crack_faces);
  if (body.resample_limit > 0) insert_near(body, delta.crack.new_crack_faces, 0, body.updates);
  const double resample = since(clock);
  auto update = update_graph(body.nodes, delta.first_new_node, delta.moved_nodes, faces, near, body.k, body.grid,
                             body.graph, body.neighbors);
  std::set<NodeId> updated(update.updated_nodes.begin(), update.updated_nodes.end());
  // Each piece that the crack cut off needs nodes, connected among themselves. Global: once over graph and complex, the
  // one part of a split whose cost does not follow the cut.
  connect_pieces(body, [&](NodeId first_new, std::span<const NodePair> joins) {
    const auto more =
        update_graph(body.nodes, first_new, {}, {}, near, body.k, body.grid, body.graph, body.neighbors, joins);
    updated.insert(more.updated_nodes.begin(), more.updated_nodes.end());
  });
  delta.updated_nodes.assign(updated.begin(), updated.end());
  mark_debris(body, delta.updated_nodes);
  const double graph = since(clock);
  rebind(body, delta.crack, delta.first_new_node, delta.moved_nodes, delta.rebound);
  delta.donors = body.donors;
  ++body.updates;
  if (work) {
    work->resample_seconds += resample, work->graph_seconds += graph, work->binding_seconds += since(clock);
    work->edges_cut += update.cut_edges.size(), work->edges_added += update.added_edges.size();
    work->nodes_updated += delta.updated_nodes.size(),
        work->nodes_added += body.nodes.size() - delta.first_new_node.index();
    work->nodes_moved += delta.moved_nodes.size(), work->orphans += delta.rebound.size();
  }
  return delta;
}

}  // namespace

BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitWork* work) {
  return follow_delta(body, advance(body.surface, front, next, options, work ? &work->crack : nullptr), work);
}

BodyDelta follow(Body& body, const Complex& surface, SplitWork* work) {
  return follow_delta(body, body.surface.apply(body.surface.difference(surface)), work);
}

}  // namespace geo
