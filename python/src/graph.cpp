// VisibilityGraph, and its construction from plain nodes and triangles.
#include "graph.h"

#include <string>

#include "bind.h"
#include "kerf/error.h"
#include "progress.h"

namespace kerf_python {
namespace {

using Corners = std::vector<std::array<geo::Vec3, 3>>;

// Triangles of a mesh, or of an (m, 3, 3) array; none for None.
Corners obstacles_from(py::handle object) {
  if (object.is_none()) return {};
  if (py::isinstance<Mesh>(object) || py::hasattr(object, "faces"))
    return geo::corners_of(mesh_argument(object, "obstacles")->mesh);
  const auto [shape, values] = values_from(object, "obstacles", 3, 3);
  if (shape[1] != 3 || shape[2] != 3) throw geo::InputError("obstacles: give a mesh, or corners of shape (m, 3, 3)");
  Corners out(shape[0]);
  for (std::size_t t = 0; t < out.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      out[t][k] = Eigen::Map<const geo::Vec3>(&values[9 * t + 3 * k]);
      if (!geo::in_range(out[t][k])) throw geo::InputError("obstacles: a corner is above 1e60; correct it");
    }
  return out;
}

// The neighbours as arrays.
void make_rows(Graph& self) {
  if (self.indptr) return;
  geo::CsrArrays arrays;
  {
    const GilRelease release;
    arrays = geo::neighbor_arrays(*self.nodes, self.graph);
  }
  py::object indices = moved<std::int32_t>(std::move(arrays.indices)),
             distances = moved<float>(std::move(arrays.distances)),
             indptr = moved<std::int64_t>(std::move(arrays.indptr));
  self.indices = std::move(indices);
  self.distances = std::move(distances);
  self.indptr = std::move(indptr);
}

// The fields of neighbours that neighbor_arrays() leaves out.
void make_fields(Graph& self) {
  if (self.warped) return;
  std::vector<std::uint32_t> warped;
  std::vector<std::uint8_t> hidden;
  {
    const GilRelease release;
    for (std::size_t i = 0; i < self.nodes->size(); ++i)
      for (const geo::Neighbor n : self.graph.neighbors(*self.nodes, geo::NodeId(i))) {
        warped.push_back(n.warped);
        hidden.push_back(n.hidden);
      }
  }
  static_assert(sizeof(bool) == 1);
  py::object w = moved<std::uint32_t>(std::move(warped)), h = moved<bool>(std::move(hidden));
  self.hidden = std::move(h);
  self.warped = std::move(w);
}

void make_edges(Graph& self) {
  if (self.edges) return;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<float> lengths;
  {
    const GilRelease release;
    const auto arrays = geo::edge_arrays(*self.nodes, self.graph);
    edges.reserve(arrays.indices.size() / 2);
    lengths.reserve(arrays.indices.size() / 2);
    for (std::size_t i = 0; i + 1 < arrays.indptr.size(); ++i)
      for (auto at = arrays.indptr[i]; at < arrays.indptr[i + 1]; ++at)
        if (i < arrays.indices[at]) {
          edges.push_back({static_cast<std::uint32_t>(i), arrays.indices[at]});
          lengths.push_back(arrays.distances[at]);
        }
  }
  py::object e = moved<std::uint32_t>(std::move(edges), {2}), l = moved<float>(std::move(lengths));
  self.edge_lengths = std::move(l);
  self.edges = std::move(e);
}

geo::NodeId node_from(const Graph& self, std::int64_t node) {
  if (node < 0 || static_cast<std::size_t>(node) >= self.graph.node_count())
    throw geo::InputError("node " + std::to_string(node) + " is out of range; the graph has " +
                          std::to_string(self.graph.node_count()));
  return geo::NodeId(static_cast<std::uint32_t>(node));
}

py::tuple components(const Graph& self) {
  std::vector<std::uint32_t> labels;
  std::uint32_t count = 0;
  {
    const GilRelease release;
    count = self.graph.components(labels);
  }
  return py::make_tuple(count, moved<std::int32_t>(std::move(labels)));
}

py::tuple row(const Graph& self, std::int64_t node) {
  const auto r = self.graph.row(node_from(self, node));
  return py::make_tuple(moved<std::uint32_t>(std::vector<std::uint32_t>(r.to.begin(), r.to.end())),
                        moved<std::uint16_t>(std::vector<std::uint16_t>(r.bits.begin(), r.bits.end())),
                        moved<float>(std::vector<float>(r.paths.begin(), r.paths.end())));
}

std::shared_ptr<Graph> build_graph(const NodeSet& nodes, py::object obstacles, int k, py::object progress) {
  const auto triangles = obstacles_from(obstacles);
  if (k < 0 || k > 1000) throw geo::InputError("k: give an integer from 0 to 1000");
  ProgressReport report(std::move(progress));
  return std::make_shared<Graph>(nodes.nodes, report.run([&](geo::Progress p) {
    return geo::build_visibility_graph(*nodes.nodes, triangles, k, p);
  }));
}

std::shared_ptr<Graph> with_neighbors(const Graph& edges, py::object obstacles, const std::string& method,
                                      py::object progress) {
  const auto triangles = obstacles_from(obstacles);
  const auto how = neighbor_method(method);
  ProgressReport report(std::move(progress));
  return std::make_shared<Graph>(edges.nodes, report.run([&](geo::Progress p) {
    geo::VisibilityGraph graph = edges.graph;
    geo::build_neighborhoods(*edges.nodes, graph, triangles, how, p);
    return graph;
  }));
}

constexpr const char* graph_doc =
    "Visibility graph and the neighbours of each node along it (section 6.1, 6.2). It never changes.\n\n"
    "indptr, indices and distances are the neighbours in compressed sparse rows:\n"
    "scipy.sparse.csr_matrix((g.distances, g.indices, g.indptr)) takes them. Arrays are read-only and made once.";
constexpr const char* build_doc =
    "The graph of section 6.1: minimum spanning tree and k nearest nodes, without edges that touch an obstacle.\n\n"
    "nodes: NodeSet. obstacles: Mesh, (m, 3, 3) corners, or None. Neighbours are not yet found: see\n"
    "build_neighborhoods(). Returns a VisibilityGraph. Raises InputError.";
constexpr const char* neighbors_doc =
    "Finds all nodes within the support radius of each node along the graph (section 6.2).\n\n"
    "graph: from build_visibility_graph(). obstacles: as there. method: 'automatic', 'dijkstra' or 'mfw' (the paper's\n"
    "modified Floyd-Warshall); all give the same. Returns another VisibilityGraph. Raises InputError.";

template <class Class>
void add_rows(Class& graph) {
  const auto field = [&](const char* name, void (*make)(Graph&), py::object Graph::*member, const char* doc) {
    graph.def_property_readonly(
        name,
        [make, member](Graph& self) {
          make(self);
          return self.*member;
        },
        doc);
  };
  field("indptr", &make_rows, &Graph::indptr,
        "Where each node's neighbours begin in indices and distances, (n + 1,) int64. Read-only.");
  field("indices", &make_rows, &Graph::indices,
        "Neighbours of each node, ascending; each pair in both rows. (indptr[-1],) int32. Read-only.");
  field("distances", &make_rows, &Graph::distances,
        "Argument of the kernel for each neighbour, model units: Euclidean where the pair sees each other, else the\n"
        "length of the shortest path. float32. Read-only.");
  field("warped", &make_fields, &Graph::warped,
        "Graph distance of each neighbour in 2**-24 support radii, rounded down to 2**-14 of a radius (section 6.4).\n"
        "uint32, one for each of indices. Read-only.");
  field("hidden", &make_fields, &Graph::hidden,
        "Whether a face lies between the pair. bool, one for each of indices. Read-only.");
}

}  // namespace

geo::NeighborMethod neighbor_method(const std::string& name) {
  if (name == "automatic") return geo::NeighborMethod::automatic;
  if (name == "dijkstra") return geo::NeighborMethod::dijkstra;
  if (name == "mfw") return geo::NeighborMethod::mfw;
  throw geo::InputError("method: '" + name + "' is unknown; give 'automatic', 'dijkstra' or 'mfw'");
}

void bind_graph(py::module_& module) {
  py::class_<Graph, std::shared_ptr<Graph>> graph(module, "VisibilityGraph", graph_doc);
  add_rows(graph);
  graph
      .def_property_readonly(
          "nodes", [](const Graph& self) { return NodeSet(self.nodes); }, "The graph's nodes.")
      .def_property_readonly(
          "node_count", [](const Graph& self) { return self.graph.node_count(); }, "Number of nodes.")
      .def_property_readonly(
          "edge_count", [](const Graph& self) { return self.graph.edge_count(); }, "Number of edges between nodes.")
      .def_property_readonly(
          "guide_count", [](const Graph& self) { return self.graph.guide_count(); },
          "Number of guides (section 8): points that shortest paths pass through. Retired ones are included.")
      .def_property_readonly(
          "bytes", [](const Graph& self) { return self.graph.bytes(); }, "Bytes of all rows and guides.")
      .def_property_readonly(
          "edges",
          [](Graph& self) {
            make_edges(self);
            return self.edges;
          },
          "Edges i < j between nodes, ascending, (e, 2) uint32. Read-only.")
      .def_property_readonly(
          "edge_lengths",
          [](Graph& self) {
            make_edges(self);
            return self.edge_lengths;
          },
          "Euclidean length of each edge, (e,) float32, model units. Read-only.")
      .def("components", &components,
           "Number of components, and the component of each node, (n,) int32, as SciPy's connected_components().\n"
           "Components are numbered by their lowest nodes.")
      .def("row", &row, py::arg("node"),
           "The adjacency row of a node: ids, bits and path lengths (docs/formats.md). Ids from 2**31 on are guides.\n"
           "Raises InputError.")
      .def(
          "has_edge",
          [](const Graph& self, std::int64_t i, std::int64_t j) {
            return self.graph.has_edge(node_from(self, i), node_from(self, j));
          },
          py::arg("i"), py::arg("j"), "Whether the edge ij exists. Raises InputError for a node out of range.")
      .def(
          "__eq__", [](const Graph& self, const Graph& other) { return self.graph == other.graph; }, py::is_operator(),
          "Whether edges, neighbours and guides are the same, to the last bit.")
      .def("__len__", [](const Graph& self) { return self.graph.node_count(); })
      .def("__repr__", [](const Graph& self) {
        return "<kerf.VisibilityGraph of " + std::to_string(self.graph.node_count()) + " nodes and " +
               std::to_string(self.graph.edge_count()) + " edges>";
      });
  graph.attr("__hash__") = py::none();
  module.def("build_visibility_graph", &build_graph, py::arg("nodes"), py::arg("obstacles") = py::none(),
             py::arg("k") = 26, py::kw_only(), py::arg("progress") = py::none(), build_doc);
  module.def("build_neighborhoods", &with_neighbors, py::arg("graph"), py::arg("obstacles") = py::none(),
             py::arg("method") = "automatic", py::kw_only(), py::arg("progress") = py::none(), neighbors_doc);
}

}  // namespace kerf_python
