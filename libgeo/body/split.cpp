// The seven steps of § 4, one call a line.
#include <algorithm>
#include <chrono>
#include <set>

#include "body/agreement.h"
#include "body/binding.h"
#include "body/connect.h"
#include "body/front_guides.h"
#include "body/locate.h"
#include "graph/update.h"

namespace geo {
namespace {

double since(std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last).count();
  last = now;
  return seconds;
}

BodyDelta follow_delta(Body& body, CrackDelta crack, SplitWork* work, const Progress& progress = {}) {
  auto clock = std::chrono::steady_clock::now();
  BodyDelta delta;
  delta.crack = std::move(crack);
  delta.first_new_node = NodeId(body.nodes.size());
  body.donors.clear();
  if (delta.crack.empty()) return delta;
  std::vector<std::array<Vec3, 3>> faces;
  for (const FaceId f : delta.crack.new_faces) faces.push_back(body.surface.corners(f));
  // Where rounding moved a part of a face, two nodes may see each other past it now.
  for (const FaceId f : delta.crack.removed_faces) faces.push_back(body.surface.corners(f));
  const TrianglesNear near = triangles_near(body.surface);

  report(progress, "new nodes", 0, delta.crack.new_crack_faces.size());
  delta.moved_nodes = move_off(body, delta.crack.new_crack_faces);
  if (body.resample_limit > 0) insert_near(body, delta.crack.new_crack_faces, 0, body.updates);
  const double resample = since(clock);
  auto update = update_graph({.nodes = body.nodes,
                              .grid = body.grid,
                              .first_new = delta.first_new_node,
                              .k = body.k,
                              .triangles_near = near,
                              .new_faces = faces,
                              .moved = delta.moved_nodes,
                              .guides = guides_after(body, delta.crack)},
                             body.graph, progress);
  std::set<NodeId> updated(update.updated_nodes.begin(), update.updated_nodes.end());
  // Each piece that the crack cut off needs nodes, connected among themselves.
  bool recounted = false;
  const auto offcuts = part_pieces(body, delta.crack, recounted);
  std::vector<std::uint32_t> component;
  if (recounted) body.graph.components(component);
  auto found = recounted ? find_disagreement(body, component)
                         : find_disagreement(body, update.cut_edges, offcuts, delta.crack.touched_surface_vertices,
                                             delta.first_new_node);
  const std::size_t sampled = body.nodes.size();
  mend(body, found, [&](NodeId first_new, std::span<const NodePair> joins) {
    const auto more = update_graph({.nodes = body.nodes,
                                    .grid = body.grid,
                                    .first_new = first_new,
                                    .k = body.k,
                                    .triangles_near = near,
                                    .joins = joins},
                                   body.graph);
    updated.insert(more.updated_nodes.begin(), more.updated_nodes.end());
  });
  delta.parted = parted_nodes(body, offcuts, found);
  delta.updated_nodes.assign(updated.begin(), updated.end());
  mark_debris(body, delta.updated_nodes);
  const double graph = since(clock);
  report(progress, "binding", 0, delta.crack.new_faces.size());
  delta.rebound = rebind(body, delta.crack, delta.first_new_node, delta.moved_nodes);
  delta.donors = body.donors;
  ++body.updates;
  if (work) {
    work->resample_seconds += resample, work->graph_seconds += graph, work->binding_seconds += since(clock);
    work->edges_cut += update.cut_edges.size(), work->edges_added += update.added_edges.size();
    work->nodes_updated += delta.updated_nodes.size(),
        work->nodes_added += body.nodes.size() - delta.first_new_node.index();
    work->nodes_mended += body.nodes.size() - sampled;
    work->nodes_moved += delta.moved_nodes.size(), work->orphans += delta.rebound.size();
  }
  return delta;
}

}  // namespace

BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitWork* work) {
  begin_upkeep(body);
  return follow_delta(body, advance(body.surface, front, next, options, work ? &work->crack : nullptr), work);
}

BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitWork* work, const Agreement& agree) {
  if (!agree) return split(body, front, next, options, work);
  begin_upkeep(body);
  FrontState moved = front;
  CrackDelta crack = advance(body.surface, moved, next, options, work ? &work->crack : nullptr);
  if (!crack.empty()) {
    try {
      agree(body.surface, crack);
    } catch (...) {
      body.surface.undo();
      throw;
    }
  }
  front = std::move(moved);
  return follow_delta(body, std::move(crack), work);
}

BodyDelta follow(Body& body, const Complex& surface, SplitWork* work, const Progress& progress) {
  report(progress, "surface", 0, 1);
  begin_upkeep(body);
  return follow_delta(body, body.surface.apply(body.surface.difference(surface)), work, progress);
}

}  // namespace geo
