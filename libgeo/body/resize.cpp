// resize_nodes() of kerf/body.h. A radius changes warped lengths: rows near the node are
// recomputed, and its closest vertex is searched within the new radius.
#include <algorithm>
#include <string>

#include "body/binding.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "body/node_insertion.h"
#include "body/piece_labels.h"
#include "graph/update.h"
#include "kerf/error.h"

namespace geo {

BodyDelta resize_nodes(Body& body, std::span<const std::pair<NodeId, double>> radii) {
  for (const auto& [i, radius] : radii)
    if (!(radius > 0))
      throw InputError("node " + std::to_string(i.index()) + " cannot have a support radius of " +
                       std::to_string(radius));
  prepare_cache(body);
  BodyDelta delta;
  delta.first_new_node = NodeId(body.nodes.size());
  std::vector<NodeId> resized;
  for (const auto& [i, wanted] : radii) {
    double& now = body.nodes.radius[i.index()];
    const double radius = std::min(wanted, body.widest_radius);
    if (now == radius) continue;
    delta.resized_nodes.push_back({i, double(now)});
    resized.push_back(i);
    now = radius;
  }
  if (resized.empty()) return delta;
  delta.updated_nodes = update_graph({.nodes = body.nodes,
                                      .grid = body.cache->grid,
                                      .first_new = delta.first_new_node,
                                      .k = body.k,
                                      .triangles_near = triangles_near(body.surface),
                                      .resized = resized},
                                     body.graph)
                            .updated_nodes;
  mark_debris(body, delta.updated_nodes);
  // The radius bounds the search for the closest vertex.
  BindingUpdate binding(body);
  binding.follow_step({}, delta.first_new_node, resized, {});
  delta.rebound_vertices = binding.finish();
  return delta;
}

}  // namespace geo
