// Edges of the uncut graph that the body lacks. The uncut graph is that of a body before the
// cracks, or is built within the skin alone.
#include "view/cut_edges.h"

#include <algorithm>

#include <kerf/error.h>

namespace view {
namespace {

geo::VisibilityGraph graph_within_skin(const geo::Body& body) {
  std::vector<std::array<geo::Vec3, 3>> skin;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(geo::FaceId(f)) && body.surface.face(geo::FaceId(f)).crack == 0)
      skin.push_back(body.surface.corners(geo::FaceId(f)));
  return geo::build_visibility_graph(body.nodes, skin, body.k);
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> cut_edges(const geo::Body& body, const geo::Body* before) {
  const geo::VisibilityGraph rebuilt = before ? geo::VisibilityGraph() : graph_within_skin(body);
  const geo::VisibilityGraph& whole = before ? before->graph : rebuilt;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cut;
  for (std::uint32_t i = 0; i < std::min(whole.node_count(), body.nodes.size()); ++i)
    for (const geo::NodeId j : whole.edges(geo::NodeId(i)))
      if (j.value > i && j.index() < body.nodes.size() && !body.graph.has_edge(geo::NodeId(i), j))
        cut.push_back({i, j.value});
  return cut;
}

std::vector<std::uint8_t> updated_nodes(const geo::Body& body, const geo::Body& before) {
  if (before.nodes.size() > body.nodes.size())
    throw geo::InputError("the body before has more nodes than the one after; exchange them");
  std::vector<std::uint8_t> updated(body.nodes.size(), 1);
  for (std::uint32_t i = 0; i < before.nodes.size(); ++i)
    updated[i] = !(before.graph.row(geo::NodeId(i)) == body.graph.row(geo::NodeId(i)));
  return updated;
}

}  // namespace view
