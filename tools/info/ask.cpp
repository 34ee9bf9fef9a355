// Looks up one row of the graph or one path of the binding, and prints it.
#include "info/ask.h"

#include <algorithm>
#include <set>

#include <kerf/error.h>
#include "tool.h"

namespace info {
namespace {

std::string place(const geo::Vec3& p) { return list({tool::number(p.x()), tool::number(p.y()), tool::number(p.z())}); }

void require(const char* what, std::size_t i, std::size_t count) {
  if (i >= count)
    throw geo::InputError("there is no " + std::string(what) + " " + std::to_string(i) + "; the last is " +
                          (count ? std::to_string(count - 1) : "none"));
}

std::string words(const geo::Vec3& p) {
  return "(" + rounded(p.x()) + ", " + rounded(p.y()) + ", " + rounded(p.z()) + ")";
}

}  // namespace

void ask_node(const geo::Body& body, std::size_t i, Report& report) {
  require("node", i, body.nodes.size());
  const geo::NodeId node(i);
  std::vector<std::uint32_t> component, edges, masters;
  body.graph.components(component);
  for (const geo::NodeId j : body.graph.edges(node)) edges.push_back(j.value);
  std::size_t hidden = 0;
  std::vector<std::string> neighbors;
  for (const auto& n : body.graph.neighbors(body.nodes, node)) {
    hidden += n.hidden;
    neighbors.push_back("{\"node\":" + std::to_string(n.to.value) + ",\"distance\":" + tool::number(n.distance) +
                        ",\"seen\":" + (n.hidden ? "false" : "true") + "}");
  }
  for (std::uint32_t v = 0; v < body.binding.master_node.size(); ++v)
    if (body.binding.master_node[v] == node) masters.push_back(v);
  report.headline = "Node " + std::to_string(i) + " at " + words(body.nodes.position[i]) + ": " +
                    counted(edges.size(), "edge") + ", " + counted(neighbors.size(), "neighbour") +
                    (hidden == 0 ? "" : ", " + std::to_string(hidden) + " of them behind a face") +
                    "; carries the trees of " + counted(masters.size(), "master") + "." +
                    (body.debris[i] ? " It is debris." : "");
  report.add("node", i);
  report.add("position", place(body.nodes.position[i]));
  report.add_number("radius", body.nodes.radius[i]);
  report.add_number("spacing", body.nodes.spacing[i]);
  report.add_number("volume", body.nodes.volume[i]);
  report.add("debris", body.debris[i] != 0);
  report.add("component", static_cast<std::size_t>(component[i]));
  report.add("edges", numbers(edges));
  report.add("neighbors", list(neighbors));
  report.add("masters", numbers(masters));
}

void ask_edge(const geo::Body& body, std::size_t i, std::size_t j, Report& report) {
  require("node", i, body.nodes.size());
  require("node", j, body.nodes.size());
  if (i == j) throw geo::InputError("an edge has two different nodes");
  const geo::Vec3 &p = body.nodes.position[i], &q = body.nodes.position[j];
  std::vector<std::string> faces;
  for (const geo::FaceId f : geo::faces_on_segment(body.surface, p, q))
    faces.push_back("{\"face\":" + std::to_string(f.value) +
                    ",\"crack\":" + std::to_string(body.surface.face(f).crack) + "}");
  const bool edge = body.graph.has_edge(geo::NodeId(i), geo::NodeId(j));
  const double straight = (p - q).norm();
  std::string distance = "null";
  for (const auto& n : body.graph.neighbors(body.nodes, geo::NodeId(i)))
    if (n.to.index() == j) distance = tool::number(n.distance);
  report.headline = "Nodes " + std::to_string(i) + " and " + std::to_string(j) + ", " + rounded(straight) +
                    " apart: " + (edge ? "an edge" : "no edge") + ", " +
                    (distance == "null" ? "no neighbours" : "neighbours") +
                    (faces.empty() ? ", in sight of each other." : ", behind " + counted(faces.size(), "face") + ".");
  report.add("nodes", numbers(std::vector{i, j}));
  report.add("edge", edge);
  report.add("visible", faces.empty());
  report.add_number("straight", straight);
  report.add("neighbors", distance != "null");
  report.add("distance", distance);
  report.add("faces", list(faces));
}

void ask_vertex(const geo::Body& body, std::size_t v, Report& report) {
  require("surface vertex", v, body.surface.surface_vertex_count());
  const geo::SurfaceVertexId vertex(v);
  if (!body.surface.alive(vertex)) throw geo::InputError("surface vertex " + std::to_string(v) + " is no more");
  const geo::Binding& binding = body.binding;
  std::vector<std::uint32_t> way{vertex.value};
  while (binding.master[way.back()].valid() && binding.parent[way.back()].value != way.back())
    way.push_back(binding.parent[way.back()].value);
  const bool orphan = !binding.master[v].valid();
  const geo::NodeId node = orphan ? geo::NodeId() : binding.master_node[binding.master[v].index()];
  std::vector<std::pair<geo::NodeId, double>> bound;
  if (!orphan) geo::carrier_nodes(body, vertex, bound);
  std::vector<std::string> nodes;
  for (const auto& [id, distance] : bound)
    nodes.push_back("{\"node\":" + std::to_string(id.value) + ",\"distance\":" + tool::number(distance) + "}");
  const geo::Vec3& at = body.surface.point(body.surface.site(vertex));
  report.headline =
      "Surface vertex " + std::to_string(v) + " at " + words(at) +
      (orphan            ? ": an orphan, which no node carries."
       : way.size() == 1 ? ": the master of node " + std::to_string(node.value) + "."
                         : ": " + counted(way.size() - 1, "step") + " from master " + std::to_string(way.back()) +
                               " of node " + std::to_string(node.value) + ".");
  report.add("vertex", v);
  report.add("position", place(at));
  report.add("site", static_cast<std::size_t>(body.surface.site(vertex).value));
  report.add("master", orphan ? "null" : std::to_string(binding.master[v].value));
  report.add("master_node", orphan ? "null" : std::to_string(node.value));
  report.add("way", numbers(way));
  report.add("nodes", list(nodes));
}

void ask_vertex(const geo::TriangleMesh& mesh, std::size_t v, Report& report) {
  require("vertex", v, mesh.vertices.size());
  std::vector<std::size_t> triangles;
  std::set<std::int32_t> patches;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (std::find(mesh.triangles[t].begin(), mesh.triangles[t].end(), v) != mesh.triangles[t].end()) {
      triangles.push_back(t);
      if (!mesh.patch.empty()) patches.insert(mesh.patch[t]);
    }
  std::vector<std::size_t> copies;
  if (mesh.two_sided())
    for (std::size_t o = 0; o < mesh.site.size(); ++o)
      if (o != v && mesh.site[o] == mesh.site[v]) copies.push_back(o);
  report.headline =
      "Vertex " + std::to_string(v) + " at " + words(mesh.vertices[v]) + ": " + counted(triangles.size(), "triangle") +
      (copies.empty() ? "." : ", " + counted(copies.size(), "other vertex", "other vertices") + " at its place.");
  report.add("vertex", v);
  report.add("position", place(mesh.vertices[v]));
  report.add("triangles", numbers(triangles));
  report.add("patches", numbers(patches));
  if (mesh.two_sided()) {
    report.add("site", static_cast<std::size_t>(mesh.site[v]));
    report.add("copies", numbers(copies));
  }
}

}  // namespace info
