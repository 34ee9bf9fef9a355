// build_body() of kerf/body.h. From the nodes and faces of K: visibility graph (§ 6.1), repairs of
// its connectivity (§ 6.4), guides (§ 8), neighbours (§ 6.2), binding (§ 6.5), in this order.
#include <numeric>

#include "body/connectivity.h"
#include "body/front_guides.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "body/node_insertion.h"
#include "graph/build_graph.h"
#include "graph/guide_edges.h"
#include "graph/update.h"
#include "kerf/error.h"

namespace geo {
namespace {

// No edge touches a face, so all nodes of a component are inside when one of them is.
void require_inside(const Body& body, const std::vector<std::uint32_t>& component) {
  std::uint32_t tested = 0;  // components are numbered by their lowest nodes
  for (std::size_t i = 0; i < component.size(); ++i)
    if (component[i] == tested && ++tested > 0 && !is_inside(body.surface, body.nodes.position[i]))
      throw InputError("node " + std::to_string(i) +
                       " is not inside the surface; sample the same model that the body is made of");
}

}  // namespace

Body build_body(Complex surface, NodeSet nodes, const BodyOptions& options, const Progress& progress,
                std::vector<NodeId>* donors) {
  if (nodes.size() == 0) throw InputError("there are no nodes; make some with kerf-sample");
  if (options.k < 3 || options.k > 1000) throw InputError("k must be from 3 to 1000");
  if (options.guide_spacing != 0 && !(options.guide_spacing >= 0.05 && options.guide_spacing <= 10))
    throw InputError("guides must be 0 or from 0.05 to 10");
  Body body;
  body.surface = std::move(surface);
  body.nodes = std::move(nodes);
  body.k = options.k;
  body.guide_spacing = options.guide_spacing;
  set_original_nodes(body, static_cast<std::uint32_t>(body.nodes.size()));
  body.debris.assign(body.nodes.size(), 0);
  body.cache->grid =
      NodeGrid(std::accumulate(body.nodes.spacing.begin(), body.nodes.spacing.end(), 0.0) / double(body.nodes.size()),
               body.nodes.position);
  std::vector<std::array<Vec3, 3>> soup;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) soup.push_back(body.surface.corners(FaceId(f)));
  const TriangleBvh obstacles(soup);
  body.graph = build_visibility_graph(body.nodes, obstacles, body.k, progress);
  {
    std::vector<std::uint32_t> component;
    body.graph.components(component);
    require_inside(body, component);
    label_pieces(body);
    auto mismatch = find_mismatch(body, component);
    NewNodes inserted(body);
    repair_connectivity(inserted, mismatch, [&](NodeId first_new, std::span<const NodePair> joins) {
      update_graph({.nodes = body.nodes,
                    .grid = body.cache->grid,
                    .first_new = first_new,
                    .k = body.k,
                    .triangles_near = triangles_near(body.surface),
                    .joins = joins},
                   body.graph);
    });
    if (donors) *donors = inserted.donors();
  }
  if (body.guide_spacing > 0) add_guides(body.nodes, body.cache->grid, obstacles, all_guides(body), body.graph);
  build_neighborhoods(body.nodes, body.graph, obstacles, options.method, progress);
  report(progress, "binding", 0, body.nodes.size());
  body.binding = build_binding(body);
  std::vector<NodeId> all;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) all.push_back(NodeId(i));
  mark_debris(body, all);
  return body;
}

}  // namespace geo
