// Body: construction, snapshots, checks.
#include "body.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>

#include "arguments.h"
#include "bind.h"
#include "complex.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "progress.h"

namespace kerf_python {
namespace {

// A snapshot of a part: made by `make` unless it is there.
template <class Make>
py::object snapshot(Body& self, py::object Body::*part, const Make& make) {
  const Reading reading(self.busy);
  if (!(self.*part)) self.*part = py::cast(make(self.body));
  return self.*part;
}

std::shared_ptr<Graph> graph_of(const geo::Body& body) {
  const GilRelease release;
  return std::make_shared<Graph>(std::make_shared<const geo::NodeSet>(body.nodes), body.graph);
}

std::shared_ptr<Mesh> surface_of(const Body& self) {
  const GilRelease release;
  auto mesh = self.body.surface.two_sided();
  if (self.model) geo::transfer_attributes(self.model->mesh, mesh);
  return std::make_shared<Mesh>(std::move(mesh));
}

// Arrays of a binding.
struct Binding {
  py::array master_node, master, parent, closest, vertex;
};

Binding binding_of(const geo::Body& body) {
  std::vector<geo::SurfaceVertexId> alive;
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
    if (body.surface.alive(geo::SurfaceVertexId(v))) alive.push_back(geo::SurfaceVertexId(v));
  auto b = body.binding;
  return {moved_ids(std::move(b.master_node)), moved_ids(std::move(b.master)), moved_ids(std::move(b.parent)),
          moved_ids(std::move(b.closest)), moved_ids(std::move(alive))};
}

using Carriers = std::vector<std::pair<geo::NodeId, double>>;

py::tuple carriers_of(Body& self, std::int64_t vertex) {
  const Reading reading(self.busy);
  const auto& surface = self.body.surface;
  if (vertex < 0 || vertex >= surface.surface_vertex_count() ||
      !surface.alive(geo::SurfaceVertexId(static_cast<std::uint32_t>(vertex))))
    throw geo::InputError("vertex " + std::to_string(vertex) + ": no such surface vertex; see binding.vertex");
  Carriers carriers;
  geo::carrier_nodes(self.body, geo::SurfaceVertexId(static_cast<std::uint32_t>(vertex)), carriers);
  std::vector<std::uint32_t> nodes;
  std::vector<double> distances;
  for (const auto& [node, distance] : carriers) {
    nodes.push_back(node.value);
    distances.push_back(distance);
  }
  return py::make_tuple(moved<std::uint32_t>(std::move(nodes)), moved<double>(std::move(distances)));
}

py::tuple all_carriers(Body& self) {
  const Reading reading(self.busy);
  std::vector<std::int64_t> indptr{0};
  std::vector<std::int32_t> nodes;
  std::vector<double> distances;
  {
    const GilRelease release;
    Carriers carriers;
    for (std::uint32_t v = 0; v < self.body.surface.surface_vertex_count(); ++v) {
      if (!self.body.surface.alive(geo::SurfaceVertexId(v))) continue;
      carriers.clear();
      geo::carrier_nodes(self.body, geo::SurfaceVertexId(v), carriers);
      for (const auto& [node, distance] : carriers) {
        nodes.push_back(static_cast<std::int32_t>(node.value));
        distances.push_back(distance);
      }
      indptr.push_back(static_cast<std::int64_t>(nodes.size()));
    }
  }
  return py::make_tuple(moved<std::int64_t>(std::move(indptr)), moved<std::int32_t>(std::move(nodes)),
                        moved<double>(std::move(distances)));
}

geo::BodyOptions body_options(int k, double guide_spacing, const std::string& method) {
  geo::BodyOptions options;
  options.k = k;
  options.guide_spacing = guide_spacing;
  options.method = neighbor_method(method);
  return options;
}

// Nodes are sampled of the model, and cracks are inserted afterwards as update() does, so that they
// get new nodes. Where the cracks have not grown from the model, nodes are those of the cut
// surface.
geo::Body built_around_cracks(const Subject& subject, const geo::SampleOptions& sampling,
                              const geo::BodyOptions& options, const geo::Progress& progress) {
  const auto& model = subject.model->mesh;
  auto body = geo::build_body(geo::Complex::from_two_sided(model), geo::sample_nodes(model, sampling, progress),
                              options, progress);
  if (subject.complex.crack_count() == body.surface.crack_count()) return body;
  try {
    body.surface.difference(subject.complex);
  } catch (const geo::InputError&) {
    return geo::build_body(subject.complex, geo::sample_nodes(subject.complex.two_sided(), sampling, progress), options,
                           progress);
  }
  geo::update_body(body, subject.complex, nullptr, progress);
  return body;
}

// Builds a body of a surface; nodes are sampled where none are given.
std::shared_ptr<Body> built(py::object object, py::object nodes, const SampleArguments& sampling,
                            const geo::BodyOptions& options, py::object progress) {
  if (!nodes.is_none() && (!sampling.spacing.is_none() || !sampling.count.is_none()))
    throw geo::InputError("nodes, spacing: give one of them");
  if (!nodes.is_none() && !py::isinstance<NodeSet>(nodes)) throw py::type_error("nodes: give a kerf.NodeSet, or None");
  const auto subject = subject_from(object, "model");
  ProgressReport report(std::move(progress));
  const auto wanted = sample_options(sampling, subject.complex.extent().diagonal());
  const auto given = nodes.is_none() ? nullptr : nodes.cast<const NodeSet&>().nodes;
  auto body = report.run([&](geo::Progress p) {
    auto made =
        given ? geo::build_body(subject.complex, *given, options, p) : built_around_cracks(subject, wanted, options, p);
    made.history.push_back({"kerf.Body", KERF_VERSION, "", {}});
    return made;
  });
  return std::make_shared<Body>(std::move(body), subject.model);
}

// A copy of the complex, whose methods give pieces and bonds.
std::shared_ptr<Complex> copy_of_complex(Body& self) {
  const Reading reading(self.busy);
  return without_gil([&] { return std::make_shared<Complex>(geo::Complex(self.body.surface), self.model); });
}

py::list history_of(Body& self) {
  const Reading reading(self.busy);
  py::list out;
  for (const auto& h : self.body.history) {
    py::dict entry;
    entry["tool"] = h.tool;
    entry["version"] = h.version;
    entry["arguments"] = h.arguments;
    entry["inputs"] = py::tuple(py::cast(h.inputs));
    out.append(std::move(entry));
  }
  return out;
}

geo::BodyReport checked(Body& self) {
  const Reading reading(self.busy);
  const GilRelease release;
  return geo::check_body(self.body);
}

constexpr const char* body_doc =
    "A deformable solid in material coordinates: surface with its cracks, nodes, visibility graph, binding\n"
    "(section 6). Lengths are in model units.\n\n"
    "Body(model, nodes=None, *, spacing, count, ...): model: Solid, two-sided Mesh, or Complex. nodes: NodeSet;\n"
    "without it the model is sampled, with the options of sample(), and near its cracks again. k: nearest neighbours "
    "of a node, 3 to 1000.\n"
    "guide_spacing: distance between guides along concave edges in spacings, 0.05 to 10; 0: none. method: see\n"
    "build_neighborhoods(). Raises InputError.\n\n"
    "A body changes by split(), update() and resize(). Its parts are snapshots: what was taken before a change stays\n"
    "as it was. Two calls at once on one body raise Error.";

void bind_binding(py::module_& module) {
  py::class_<Binding>(module, "Binding",
                      "The nodes that carry each surface vertex (section 6.5). Read-only arrays, (v,) uint32, indexed\n"
                      "by ids of surface vertices where nothing else is said. 2**32 - 1: none.")
      .def_readonly("master_node", &Binding::master_node, "Of a master: its nearest node by a visibility edge.")
      .def_readonly("master", &Binding::master, "Root of the vertex's tree.")
      .def_readonly("parent", &Binding::parent, "Next vertex on the way to the master; itself for a master.")
      .def_readonly("closest", &Binding::closest, "By node: its closest visible surface vertex within its support.")
      .def_readonly("vertex", &Binding::vertex, "The id of each vertex of Body.surface, ascending.");
  py::class_<geo::BodyReport>(module, "BodyReport", "The result of Body.check().")
      .def_readonly("graph_components", &geo::BodyReport::graph_components, "Components of the graph.")
      .def_readonly("pieces", &geo::BodyReport::pieces, "Pieces of material.")
      .def_readonly("edges_crossing", &geo::BodyReport::edges_crossing, "Edges of the graph that touch a face.")
      .def_readonly("orphans", &geo::BodyReport::orphans, "Living surface vertices without a master.")
      .def_readonly("nodes_outside", &geo::BodyReport::nodes_outside, "Nodes that are not inside the material.")
      .def_readonly("pieces_without_node", &geo::BodyReport::pieces_without_node,
                    "Pieces too thin for a node in double precision.")
      .def_readonly("first_problem", &geo::BodyReport::first_problem, "The first violated invariant; '' if all hold.")
      .def_property_readonly("good", &geo::BodyReport::good, "Whether all invariants hold.");
}

template <class T>
void number(py::class_<Body, std::shared_ptr<Body>>& body, const char* name, T geo::Body::*member, const char* doc) {
  body.def_property_readonly(
      name,
      [member](Body& self) {
        const Reading reading(self.busy);
        return self.body.*member;
      },
      doc);
}

void add_numbers(py::class_<Body, std::shared_ptr<Body>>& body) {
  number(body, "k", &geo::Body::k, "Nearest neighbours of a node in the graph.");
  number(body, "guide_spacing", &geo::Body::guide_spacing, "Distance between guides, in node spacings; 0: none.");
  number(body, "original_nodes", &geo::Body::original_nodes, "Number of nodes it was built from; they come first.");
  number(body, "finest_spacing", &geo::Body::finest_spacing, "Of the original nodes; cracks get no finer ones.");
  number(body, "widest_radius", &geo::Body::widest_radius, "Largest support radius; no node gets a wider one.");
  number(body, "crack_steps", &geo::Body::crack_steps, "Crack steps applied since the build.");
  body.def_property(
          "resample_limit",
          [](Body& self) {
            const Reading reading(self.busy);
            return self.body.resample_limit;
          },
          [](Body& self, double limit) {
            const Writing writing(self.busy);
            if (!(limit >= 0 && limit <= 1)) throw geo::InputError("resample_limit: give a number from 0 to 1");
            self.body.resample_limit = limit;
          },
          "0: cracks get no new nodes. Raises InputError for a number that is not from 0 to 1.")
      .def_property_readonly(
          "debris",
          [](Body& self) {
            const Reading reading(self.busy);
            auto debris = self.body.debris;
            debris.resize(self.body.nodes.size());
            return moved<bool>(std::move(debris));
          },
          "Whether each node is rigid debris: its neighbours do not span space. (n,) bool. Read-only.")
      .def_property_readonly("history", &history_of,
                             "Programs that have written the body, oldest first: dicts of tool, version, arguments,\n"
                             "inputs.");
}

void add_snapshots(py::class_<Body, std::shared_ptr<Body>>& body) {
  body.def_property_readonly(
          "nodes",
          [](Body& self) {
            return snapshot(self, &Body::nodes, [](const geo::Body& b) { return NodeSet(geo::NodeSet(b.nodes)); });
          },
          "The nodes, NodeSet; original ones first. Snapshot.")
      .def_property_readonly(
          "graph", [](Body& self) { return snapshot(self, &Body::graph, &graph_of); },
          "Visibility graph and neighbours, VisibilityGraph. Snapshot.")
      .def_property_readonly(
          "binding", [](Body& self) { return snapshot(self, &Body::binding, &binding_of); },
          "The nodes that carry the surface, Binding. Snapshot.")
      .def_property_readonly(
          "surface",
          [](Body& self) { return snapshot(self, &Body::surface, [&](const geo::Body&) { return surface_of(self); }); },
          "The two-sided surface with patch, site and source, Mesh; with the model's attributes where the body was\n"
          "built of a model. Snapshot.");
}

}  // namespace

Subject subject_from(py::handle object, const std::string& name) {
  if (py::isinstance<Complex>(object)) {
    auto& complex = object.cast<Complex&>();
    const Reading reading(complex.busy);
    Subject out{complex.complex, complex.model};
    if (!out.model) out.model = std::make_shared<Mesh>(out.complex.two_sided());
    return out;
  }
  auto mesh = mesh_argument(object, name);
  const bool known = mesh->is_model();
  return without_gil([&] {
    if (!known) geo::require_solid(mesh->mesh);
    return Subject{geo::Complex::from_two_sided(mesh->mesh), std::move(mesh)};
  });
}

Body::Body(geo::Body b, std::shared_ptr<Mesh> m) : body(std::move(b)), model(std::move(m)) {
  static std::atomic<std::uint64_t> bodies = 0;
  id = ++bodies;
}

void Body::changed() {
  nodes = graph = binding = surface = py::object();
  ++version;
}

std::int32_t Body::unused_crack() {
  geo::CrackNumbers numbers(body.surface);
  numbers.note(last_crack_);
  last_crack_ = numbers.next();
  return last_crack_;
}

void bind_body(py::module_& module) {
  bind_binding(module);
  py::class_<Body, std::shared_ptr<Body>> body(module, "Body", body_doc);
  body.def(py::init([](py::object model, py::object nodes, py::object spacing, py::object count, int levels,
                       double jitter, double support, std::uint64_t seed, const std::string& pattern, int across, int k,
                       double guide_spacing, const std::string& method, py::object progress) {
             return built(model, nodes, {spacing, count, levels, jitter, support, seed, pattern, across},
                          body_options(k, guide_spacing, method), std::move(progress));
           }),
           py::arg("model"), py::arg("nodes") = py::none(), py::kw_only(), py::arg("spacing") = py::none(),
           py::arg("count") = py::none(), py::arg("levels") = 2, py::arg("jitter") = 0.15, py::arg("support") = 1.8,
           py::arg("seed") = 1, py::arg("pattern") = "jitter", py::arg("across") = 0, py::arg("k") = 26,
           py::arg("guide_spacing") = 0.0, py::arg("method") = "automatic", py::arg("progress") = py::none(),
           "See the class.");
  add_numbers(body);
  add_snapshots(body);
  add_changes(body);
  add_files(body);
  body.def("complex", &copy_of_complex, "The surface with its cracks, a copy, Complex.")
      .def(
          "pieces",
          [](Body& self, const py::args& args, const py::kwargs& kwargs) {
            return py::cast(copy_of_complex(self)).attr("pieces")(*args, **kwargs);
          },
          "The pieces that cracks have separated: Complex.pieces() of complex(), with its arguments.")
      .def_property_readonly(
          "bonds", [](Body& self) { return py::object(py::cast(copy_of_complex(self)).attr("bonds")); },
          "The areas that pieces share: Complex.bonds of complex().")
      .def("check", &checked,
           "Checks every invariant against a build from scratch; returns a BodyReport. Costs more than the build.")
      .def(
          "carriers",
          [](Body& self, py::object vertex) {
            return vertex.is_none() ? all_carriers(self) : carriers_of(self, integer_from(vertex, "vertex"));
          },
          py::arg("vertex") = py::none(),
          "Nodes that carry a surface vertex, with their Euclidean distances (section 6.5): (nodes, distances).\n"
          "vertex: an id from binding.vertex. None: of every vertex of surface, as rows (indptr, nodes, distances).\n"
          "Raises InputError.")
      .def("__len__",
           [](Body& self) {
             const Reading reading(self.busy);
             return self.body.nodes.size();
           })
      .def("__repr__", [](Body& self) {
        const Reading reading(self.busy);
        return "<kerf.Body of " + std::to_string(self.body.nodes.size()) + " nodes and " +
               std::to_string(self.body.surface.live_face_count()) + " faces>";
      });
}

}  // namespace kerf_python
