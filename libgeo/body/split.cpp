// split() and update_body() of kerf/body.h.
//
// The seven steps of § 4. advance() of crack/ does steps 1 to 3 on K: front, splitting surface,
// mesh. The rest follows here: 4 cut the graph, 5 resample, 6 update neighbours, 7 rebind surface
// vertices. New nodes are placed before the graph is cut, so that one update serves steps 4 and 6.
#include <algorithm>
#include <array>
#include <chrono>
#include <set>

#include "body/binding.h"
#include "body/connectivity.h"
#include "body/crack_transaction.h"
#include "body/front_guides.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "graph/update.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

double seconds_since(std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last).count();
  last = now;
  return seconds;
}

// Triangles that may cut or free a line of sight: new faces, and faces that went, since rounding
// may have moved their children off them.
std::vector<std::array<Vec3, 3>> changed_triangles(const Complex& surface, const CrackDelta& crack) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const FaceId f : crack.new_faces) triangles.push_back(surface.corners(f));
  for (const FaceId f : crack.removed_faces) triangles.push_back(surface.corners(f));
  return triangles;
}

// Steps 4 to 7 for a body whose complex has taken a step already.
class BodyUpdater {
 public:
  /// `closest`: of closest_after().
  BodyUpdater(Body& body, CrackDelta crack, ClosestVertices closest, const Progress& progress)
      : body_(body),
        progress_(progress),
        near_(triangles_near(body.surface)),
        inserted_(body),
        binding_(body),
        closest_(std::move(closest)) {
    delta.crack = std::move(crack);
    delta.first_new_node = inserted_.first();
  }

  /// Step 5: moves nodes off the crack, and inserts nodes on both sides of it (§ 6.4).
  void resample() {
    const auto& faces = delta.crack.new_crack_faces;
    report(progress_, "new nodes", 0, faces.size());
    delta.moved_nodes = move_nodes_off(body_, faces);
    if (body_.resample_limit > 0) insert_nodes_near(inserted_, faces, {.seed = body_.crack_steps, .fresh = faces});
  }
  /// Steps 4 and 6: E_cut, E_new and the neighbours of P_update (§ 6.3, 6.4).
  void update_graph_and_neighbors() {
    const auto faces = changed_triangles(body_.surface, delta.crack);
    graph_update = update_graph({.nodes = body_.nodes,
                                 .grid = body_.cache->grid,
                                 .first_new = delta.first_new_node,
                                 .k = body_.k,
                                 .triangles_near = near_,
                                 .new_faces = faces,
                                 .moved = delta.moved_nodes,
                                 .guides = guides_after(body_, delta.crack)},
                                body_.graph, progress_);
    updated_.insert(graph_update.updated_nodes.begin(), graph_update.updated_nodes.end());
  }
  /// Labels of pieces, and the first part of step 7. Both need no graph.
  void follow_surface() {
    pieces_ = update_piece_labels(body_, delta.crack, relabelled_);
    binding_.follow_step(delta.crack, delta.first_new_node, delta.moved_nodes, std::move(closest_));
  }
  /// Gives each detached piece nodes, connected among themselves: G has one component for each
  /// piece.
  void match_graph_to_pieces() {
    std::vector<std::uint32_t> component;
    if (relabelled_) body_.graph.components(component);
    auto mismatch = relabelled_ ? find_mismatch(body_, component)
                                : find_mismatch(body_, graph_update.cut_edges, pieces_,
                                                delta.crack.touched_surface_vertices, delta.first_new_node);
    note_parts(body_, pieces_, mismatch);
    first_repair_node_ = body_.nodes.size();
    const auto update = [&](NodeId first_new, std::span<const NodePair> joins) {
      const auto more = update_graph({.nodes = body_.nodes,
                                      .grid = body_.cache->grid,
                                      .first_new = first_new,
                                      .k = body_.k,
                                      .triangles_near = near_,
                                      .joins = joins},
                                     body_.graph);
      updated_.insert(more.updated_nodes.begin(), more.updated_nodes.end());
    };
    repair_connectivity(inserted_, mismatch, update, {delta.crack.new_crack_faces, graph_update.cut_edges});
    const NodeId first_between(body_.nodes.size());
    if (body_.resample_limit > 0) {
      const auto joins = insert_nodes_between_walls(inserted_, delta.crack.new_crack_faces, body_.crack_steps);
      if (!joins.empty()) update(first_between, joins);
    }
    even_out_volumes(inserted_);
    delta.detached = detached_nodes(body_, pieces_, mismatch);
    delta.updated_nodes.assign(updated_.begin(), updated_.end());
    mark_debris(body_, delta.updated_nodes);
  }
  /// Step 7: masters and slaves of surface vertices (§ 6.5).
  void rebind_vertices() {
    report(progress_, "binding", 0, delta.crack.new_faces.size());
    delta.rebound_vertices = binding_.finish();
    delta.donors = inserted_.donors();
    ++body_.crack_steps;
  }
  void add_counts(SplitStats& stats) const {
    stats.edges_cut += graph_update.cut_edges.size();
    stats.edges_added += graph_update.added_edges.size();
    stats.nodes_updated += delta.updated_nodes.size();
    stats.nodes_added += body_.nodes.size() - delta.first_new_node.index();
    stats.repair_nodes += body_.nodes.size() - first_repair_node_;
    stats.nodes_moved += delta.moved_nodes.size();
    stats.orphans += delta.rebound_vertices.size();
  }

  BodyDelta delta;
  GraphUpdate graph_update;

 private:
  Body& body_;
  const Progress& progress_;
  const TrianglesNear near_;
  NewNodes inserted_;
  std::set<NodeId> updated_;  // P_update of all updates
  BindingUpdate binding_;
  ClosestVertices closest_;
  std::vector<DetachedPiece> pieces_;
  bool relabelled_ = false;
  std::size_t first_repair_node_ = 0;
};

BodyDelta update_after_crack(Body& body, CrackDelta crack, ClosestVertices closest, SplitStats* stats,
                             const Progress& progress = {}) {
  auto clock = std::chrono::steady_clock::now();
  BodyUpdater updater(body, std::move(crack), std::move(closest), progress);
  if (updater.delta.crack.empty()) return std::move(updater.delta);
  updater.resample();
  const double resample = seconds_since(clock);
  parallel_invoke([&] { updater.update_graph_and_neighbors(); }, [&] { updater.follow_surface(); });
  updater.match_graph_to_pieces();
  const double graph = seconds_since(clock);
  updater.rebind_vertices();
  if (stats) {
    stats->resample_seconds += resample;
    stats->graph_seconds += graph;
    stats->binding_seconds += seconds_since(clock);
    updater.add_counts(*stats);
  }
  return std::move(updater.delta);
}

}  // namespace

CrackTransaction::CrackTransaction(Body& body, const CrackEdit& edit, SplitStats* stats) : body_(&body), stats_(stats) {
  prepare_cache(body);
  crack_ = edit(body.surface, stats ? &stats->crack : nullptr);
  if (!crack_.empty()) open_.reset(&body.surface);
}

CrackEdit advance_of(FrontState& front, std::span<const Vec3> next, const CrackOptions& options) {
  return [&front, next, options](Complex& complex, CrackStats* stats) {
    return advance(complex, front, next, options, stats);
  };
}

void CrackTransaction::prepare() {
  if (!closest_) closest_ = closest_after(*body_, crack_);
}

BodyDelta CrackTransaction::commit(const StepVeto& veto) {
  auto clock = std::chrono::steady_clock::now();
  double veto_seconds = 0;
  const auto ask = [&] {
    auto own = std::chrono::steady_clock::now();
    if (veto && !crack_.empty()) veto(body_->surface, crack_);
    veto_seconds = seconds_since(own);
  };
  // Both read the body, and the veto decides whether it changes.
  parallel_invoke([&] { prepare(); }, ask);
  if (stats_) stats_->binding_seconds += std::max(0.0, seconds_since(clock) - veto_seconds);
  open_.release();
  return update_after_crack(*body_, std::move(crack_), std::move(*closest_), stats_);
}

BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitStats* stats) {
  FrontState advanced = front;
  BodyDelta delta = CrackTransaction(body, advance_of(advanced, next, options), stats).commit();
  front = std::move(advanced);
  return delta;
}

BodyDelta update_body(Body& body, const Complex& surface, SplitStats* stats, const Progress& progress) {
  report(progress, "surface", 0, 1);
  prepare_cache(body);
  CrackDelta crack = body.surface.apply(body.surface.difference(surface));
  ClosestVertices closest = closest_after(body, crack);
  return update_after_crack(body, std::move(crack), std::move(closest), stats, progress);
}

}  // namespace geo
