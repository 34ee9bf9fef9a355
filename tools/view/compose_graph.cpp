// add_nodes() and add_trees() of view/compose_parts.h. Edges are sticks and nodes spheres. A
// neighbour that a face hides is shown with the path to it, by Dijkstra's algorithm along edges.
#include <algorithm>
#include <map>

#include <kerf/error.h>
#include "view/compose_parts.h"
#include "view/cut_edges.h"
#include "view/fields.h"

namespace view {
namespace {

using geo::Vec3;

constexpr Color red{0.70f, 0.02f, 0.02f}, blue{0.10f, 0.22f, 0.55f}, bright{0.03f, 0.16f, 0.62f},
    orange{0.90f, 0.32f, 0.02f}, green{0.02f, 0.30f, 0.06f};

// Shortest paths along edges from a node, up to length `reach`: the predecessor of each node
// reached.
std::map<std::uint32_t, std::uint32_t> paths_from(const geo::Body& body, std::uint32_t start, double reach) {
  std::map<std::uint32_t, std::uint32_t> from;
  std::map<std::uint32_t, double> length{{start, 0}}, open = length;
  while (!open.empty()) {
    const auto next =
        std::min_element(open.begin(), open.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const auto [i, so_far] = *next;
    open.erase(next);
    for (const geo::NodeId j : body.graph.edges(geo::NodeId(i))) {
      const double d = so_far + (body.nodes.position[i] - body.nodes.position[j.index()]).norm();
      const auto known = length.find(j.value);
      if (d > reach || (known != length.end() && known->second <= d)) continue;
      length[j.value] = open[j.value] = d;
      from[j.value] = i;
    }
  }
  return from;
}

// Widths show distances; blue nodes see the node, orange ones are behind a face.
void add_neighborhood(Stage& stage, const geo::Body& body, const std::vector<Vec3>& position, std::uint32_t i) {
  const auto& spacing = body.nodes.spacing;
  stage.spheres.push_back({position[i], 0.24 * spacing[i], red});
  double reach = 0;
  for (const auto& n : body.graph.neighbors(body.nodes, geo::NodeId(i))) reach = std::max(reach, double(n.distance));
  const auto from = paths_from(body, i, 1.5 * reach);
  for (const auto& n : body.graph.neighbors(body.nodes, geo::NodeId(i))) {
    const std::uint32_t j = n.to.value;
    stage.spheres.push_back({position[j], 0.17 * spacing[j], n.hidden ? orange : bright});
    if (!n.hidden)
      stage.sticks.push_back({.a = position[i],
                              .b = position[j],
                              .radius = 0.07 * spacing[i] * (1.15 - n.distance / reach),
                              .color = bright});
    else
      for (auto step = from.find(j); step != from.end(); step = from.find(step->second))
        stage.sticks.push_back(
            {.a = position[step->first], .b = position[step->second], .radius = 0.03 * spacing[i], .color = orange});
  }
}

}  // namespace

void add_nodes(Stage& stage, const Subject& subject, const std::vector<Vec3>& position, const Look& look) {
  const geo::NodeSet& nodes = subject.nodes;
  if (look.nodes || (!subject.body && nodes.size() > 0)) {
    const auto fields = node_fields(subject);
    const auto& values = find_field(fields, look.field).values;
    const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
    const double low = values.empty() ? 0 : *lo, range = values.empty() || *hi == *lo ? 1 : *hi - *lo;
    const auto updated = subject.body && look.before ? updated_nodes(*subject.body, *look.before)
                                                     : std::vector<std::uint8_t>(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      stage.spheres.push_back(
          {position[i], 0.14 * nodes.spacing[i], updated[i] ? red : viridis((values[i] - low) / range)});
  }
  if (!subject.body) return;
  const auto stick = [&](std::uint32_t i, std::uint32_t j, double width, const Color& color) {
    stage.sticks.push_back({.a = position[i],
                            .b = position[j],
                            .radius = width * std::min(nodes.spacing[i], nodes.spacing[j]),
                            .color = color});
  };
  if (look.edges)
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      for (const geo::NodeId j : subject.body->graph.edges(geo::NodeId(i)))
        if (j.value > i) stick(i, j.value, 0.016, blue);
  if (look.cut_edges)
    for (const auto& [i, j] : cut_edges(*subject.body, look.before)) stick(i, j, 0.03, red);
  if (!look.node) return;
  if (*look.node >= nodes.size())
    throw geo::InputError("there is no node " + std::to_string(*look.node) + "; the last is " +
                          std::to_string(nodes.size() - 1));
  add_neighborhood(stage, *subject.body, position, *look.node);
}

void add_trees(Stage& stage, const Subject& subject, const std::vector<Vec3>& position, const Look& look) {
  if (!look.trees || !subject.body) return;
  const geo::Binding& binding = subject.body->binding;
  const double width = 0.0012 * geo::bounding_box(subject.surface).diagonal();
  const auto at = [&](std::uint32_t v) -> const Vec3& { return stage.surface.vertices[subject.row_of[v]]; };
  for (std::uint32_t v = 0; v < subject.row_of.size(); ++v) {
    if (subject.row_of[v] == ~0u || !binding.master[v].valid()) continue;
    const geo::NodeId node = binding.master_node[binding.master[v].index()];
    if (look.node && node.value != *look.node) continue;
    if (binding.parent[v].value != v)
      stage.sticks.push_back({.a = at(v), .b = at(binding.parent[v].value), .radius = width, .color = green});
    if (binding.parent[v].value != v || !node.valid()) continue;
    stage.spheres.push_back({at(v), 3 * width, green});
    stage.sticks.push_back({.a = at(v), .b = position[node.index()], .radius = 1.4 * width, .color = red});
  }
}

}  // namespace view
