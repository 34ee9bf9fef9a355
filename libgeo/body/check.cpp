// check_body() of kerf/body.h. Every invariant is tested independently of the updates: nodes, edges
// and pieces by exact predicates; neighbours and binding against a build from scratch, bit for bit.
#include <algorithm>

#include "body/connectivity.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/body.h"
#include "kerf/pieces.h"

namespace geo {

BodyReport check_body(const Body& body) {
  BodyReport report;
  const auto add_problem = [&](const std::string& problem) {
    if (report.first_problem.empty()) report.first_problem = problem;
  };
  const Complex& k = body.surface;
  const std::size_t n = body.nodes.size();
  std::vector<std::uint32_t> component;
  const GraphStorage& graph = GraphStorage::of(body.graph);
  report.graph_components = body.graph.components(component);
  const Pieces pieces = find_pieces(k);
  report.pieces = pieces.count;
  const auto piece_of_side = [&](Side s) {
    return pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
  };
  std::vector<std::int32_t> piece_of(report.graph_components, -1);
  std::vector<std::uint32_t> component_of(pieces.count, ~0u);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto piece = piece_containing(k, body.nodes.position[i], piece_of_side);
    if (piece < 0 || is_blocked(k, body.nodes.position[i], body.nodes.position[i])) {
      ++report.nodes_outside;
      add_problem("node " + std::to_string(i) + " is not inside the material");
      continue;
    }
    auto& known = piece_of[component[i]];
    if (known >= 0 && known != piece) add_problem("node " + std::to_string(i) + " is connected to another piece");
    known = piece;
    auto& known_component = component_of[static_cast<std::size_t>(piece)];
    if (known_component != ~0u && known_component != component[i])
      add_problem("node " + std::to_string(i) + " is not connected to others of its piece");
    known_component = component[i];
    for (const NodeId j : body.graph.edges(NodeId(i)))
      if (j.value > i && is_blocked(k, body.nodes.position[i], body.nodes.position[j.index()])) {
        ++report.edges_crossing;
        add_problem("edge " + std::to_string(i) + "-" + std::to_string(j.value) + " crosses a face");
      }
  }
  for (std::uint32_t g = 0; g < graph.guides().size(); ++g) {
    const auto id = GraphStorage::guide_id(g);
    for (const auto j : graph.entries(id).to)
      if (is_blocked(k, graph.position(body.nodes, j), graph.position(body.nodes, id))) {
        ++report.edges_crossing;
        add_problem("an edge of guide " + std::to_string(g) + " crosses a face");
      }
  }
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
    if (!k.alive(SurfaceVertexId(v))) continue;
    const auto piece = piece_of_side(k.corner_of(SurfaceVertexId(v)).first);
    if (piece < 0) {
      add_problem("surface vertex " + std::to_string(v) + " bounds no piece of the material");
      continue;
    }
    auto& known_component = component_of[static_cast<std::size_t>(piece)];
    if (known_component != ~0u) continue;
    known_component = 0;
    ++report.pieces_without_node;
    if (point_in_piece(k, SurfaceVertexId(v), body.cache->grid.cell(), piece_of_side))
      add_problem("the piece of surface vertex " + std::to_string(v) + " has no node");
  }
  std::vector<std::array<Vec3, 3>> soup;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f))) soup.push_back(k.corners(FaceId(f)));
  VisibilityGraph scratch = body.graph;
  build_neighborhoods(body.nodes, scratch, TriangleBvh(soup));
  for (std::size_t i = 0; i < n; ++i)
    if (!(scratch.row(NodeId(i)) == body.graph.row(NodeId(i)))) {
      add_problem("the neighbours of node " + std::to_string(i) + " are not those that a build from scratch finds");
      break;
    }
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v)
    if (k.alive(SurfaceVertexId(v)) && !body.binding.master[v].valid()) {
      ++report.orphans;
      add_problem("surface vertex " + std::to_string(v) + " has no master");
    }
  if (!(build_binding(body) == body.binding)) add_problem("the binding is not the one that a build from scratch finds");
  return report;
}

}  // namespace geo
