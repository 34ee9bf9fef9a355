#include <algorithm>
#include <string>

#include "body/binding.h"
#include "body/locate.h"
#include "body/nodes.h"
#include "body/upkeep.h"
#include "graph/update.h"
#include "kerf/error.h"

namespace geo {

BodyDelta resize_nodes(Body& body, std::span<const std::pair<NodeId, double>> radii) {
  for (const auto& [i, radius] : radii)
    if (!(radius > 0))
      throw InputError("node " + std::to_string(i.index()) + " cannot have a support radius of " +
                       std::to_string(radius));
  begin_upkeep(body);
  BodyDelta delta;
  delta.first_new_node = NodeId(body.nodes.size());
  body.donors.clear();
  std::vector<NodeId> resized;
  for (const auto& [i, wanted] : radii) {
    double& now = body.nodes.radius[i.index()];
    const double radius = std::min(wanted, body.widest);
    if (now == radius) continue;
    delta.resized_nodes.push_back({i, double(now)});
    resized.push_back(i);
    now = radius;
  }
  if (resized.empty()) return delta;
  delta.updated_nodes = update_graph({.nodes = body.nodes,
                                      .grid = body.grid,
                                      .first_new = delta.first_new_node,
                                      .k = body.k,
                                      .triangles_near = triangles_near(body.surface),
                                      .resized = resized},
                                     body.graph)
                            .updated_nodes;
  mark_debris(body, delta.updated_nodes);
  // How far a node looks for its closest vertex is its radius.
  delta.rebound = rebind(body, {}, delta.first_new_node, resized);
  return delta;
}

}  // namespace geo
