// DeformingSolid: construction, and updates after cuts. A step is refused where it does not follow
// the one that the solid knows.
#include "solid.h"

#include "arrays.h"
#include "bind.h"
#include "kerf/error.h"
#include "material.h"

namespace kerf_python {
namespace {

using Solids = py::class_<DeformingSolid, std::shared_ptr<DeformingSolid>>;

std::shared_ptr<DeformingSolid> of_body(Body& body, const geo::Materials& materials) {
  const Reading reading(body.busy);
  return without_gil(
      [&] { return std::make_shared<DeformingSolid>(geo::Solid(body.body, materials), body.id, body.version); });
}

std::shared_ptr<DeformingSolid> of_nodes(const NodeSet& nodes, const Graph& graph, const geo::Materials& materials) {
  if (graph.graph.node_count() != nodes.nodes->size()) throw geo::InputError("graph: belongs to other nodes");
  if (!materials.fits(nodes.nodes->size())) throw geo::InputError("materials: list another number of nodes");
  return without_gil(
      [&] { return std::make_shared<DeformingSolid>(geo::Solid(*nodes.nodes, graph.graph, materials)); });
}

void require_size(const DeformingSolid& self, const State& state) {
  const auto n = self.solid.size();
  const auto& s = state.state;
  if (s.displacement.size() != n || s.velocity.size() != n || (!s.acceleration.empty() && s.acceleration.size() != n))
    throw geo::InputError("state: has " + std::to_string(s.displacement.size()) + " nodes, the solid " +
                          std::to_string(n));
  if (!s.plastic.empty() && s.plastic.size() != self.solid.point_count())
    throw geo::InputError("state: has " + std::to_string(s.plastic.size()) + " plastic strains, the solid " +
                          std::to_string(self.solid.point_count()) + " points");
  if (!s.prestretch.empty() && s.prestretch.size() != self.solid.point_count())
    throw geo::InputError("state: has prestretch of " + std::to_string(s.prestretch.size()) + " points, the solid " +
                          std::to_string(self.solid.point_count()) + " points");
}

// The body after exactly one step behind the solid.
void require_next(const DeformingSolid& self, const Body& body, const BodyDelta& delta) {
  if (self.body != body.id || delta.body != body.id) throw geo::InputError("body, delta: belong to another body");
  if (delta.version != body.version || self.version + 1 != delta.version)
    throw geo::InputError("delta: is not the body's last change, or the solid has not followed the ones before");
}

// The body as the solid knows it.
void require_followed(const DeformingSolid& self, const Body& body) {
  if (self.body != body.id || self.version != body.version)
    throw geo::InputError("body: is another one, or the solid has not followed its changes");
}

void update(DeformingSolid& self, Body& body, const BodyDelta& delta, State& state, bool points) {
  const Writing writing(self.busy), moving(state.busy);
  const Reading reading(body.busy);
  require_next(self, body, delta);
  if (!self.points_due) require_size(self, state);
  if (state.state.displacement.size() != self.solid.size()) throw geo::InputError("state: has another number of nodes");
  without_gil([&] {
    if (points && !self.points_due)
      self.solid.update(body.body, delta.delta, state.state);
    else
      self.solid.update_nodes(body.body, delta.delta, state.state);
    if (points && self.points_due) self.solid.update_points(body.body, state.state);
  });
  self.points_due = !points;
  self.version = delta.version;
  state.changed();
}

void update_points(DeformingSolid& self, Body& body, State& state) {
  const Writing writing(self.busy), moving(state.busy);
  const Reading reading(body.busy);
  require_followed(self, body);
  if (state.state.displacement.size() != self.solid.size()) throw geo::InputError("state: has another number of nodes");
  without_gil([&] { self.solid.update_points(body.body, state.state); });
  self.points_due = false;
  state.changed();
}

void hold(DeformingSolid& self, Body& body, py::object boxes) {
  const Writing writing(self.busy);
  const Reading reading(body.busy);
  require_followed(self, body);
  require_points(self);
  const auto [shape, values] = values_from(boxes, "boxes", 2, 2);
  if (shape[1] != 6) throw geo::InputError("boxes: give rows of x0, y0, z0, x1, y1, z1");
  std::vector<geo::HeldBox> held(shape[0]);
  for (std::size_t b = 0; b < held.size(); ++b) {
    const double* const row = values.data() + 6 * b;
    held[b] = {geo::Vec3(row[0], row[1], row[2]), geo::Vec3(row[3], row[4], row[5]), true};
  }
  without_gil([&] { self.solid.hold(body.body, held); });
}

std::vector<geo::NodeId> ids_of(py::handle object, const char* name, std::size_t nodes) {
  std::vector<geo::NodeId> out;
  for (const auto id : integers_from(object, name, 0, static_cast<std::int64_t>(nodes) - 1))
    out.push_back(geo::NodeId(static_cast<std::uint32_t>(id)));
  return out;
}

void update_graph(DeformingSolid& self, const Graph& graph, py::object donors, py::object updated, State& state) {
  const Writing writing(self.busy), moving(state.busy);
  require_size(self, state);
  if (self.body != 0) throw geo::InputError("graph: the solid was made of a body; give body and delta");
  const auto n = graph.graph.node_count(), old = self.solid.size();
  if (n < old) throw geo::InputError("graph: has fewer nodes than the solid");
  const auto from = ids_of(donors, "donors", old), changed = ids_of(updated, "updated", n);
  if (from.size() != n - old) throw geo::InputError("donors: give one for each new node");
  without_gil([&] { self.solid.update(*graph.nodes, graph.graph, geo::NodeId(old), from, changed, state.state); });
  state.changed();
}

py::dict quality(DeformingSolid& self) {
  const Reading reading(self.busy);
  const auto counts = self.solid.moment_quality_counts();
  py::dict out;
  out["nodes"] = py::make_tuple(counts.nodes[0], counts.nodes[1], counts.nodes[2]);
  out["points"] = py::make_tuple(counts.points[0], counts.points[1], counts.points[2]);
  out["widened"] = counts.widened;
  return out;
}

py::array masses(DeformingSolid& self) {
  const Reading reading(self.busy);
  std::vector<double> out(self.solid.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = self.solid.mass(geo::NodeId(i));
  return moved<double>(std::move(out));
}

constexpr const char* solid_doc =
    "A deforming solid, total Lagrangian, discretised by nodes with moving-least-squares shape functions.\n\n"
    "DeformingSolid(body, materials): by the materials' discretisation. DeformingSolid(graph, materials): of a\n"
    "VisibilityGraph with neighbours and its nodes, always by 'mueller04'. materials: Material or Materials. Model\n"
    "units are metres. Raises InputError where materials list another number of nodes.\n\n"
    "A cut changes it by update(), which equals a build from scratch, bit for bit.";

void add_construction(Solids& solid) {
  solid
      .def(py::init([](Body& body, py::object materials) { return of_body(body, materials_argument(materials)); }),
           py::arg("body"), py::arg("materials"), "See the class.")
      .def(py::init([](const Graph& graph, py::object materials) {
             return of_nodes(NodeSet(graph.nodes), graph, materials_argument(materials));
           }),
           py::arg("graph"), py::arg("materials"), "See the class.")
      .def(
          "update",
          [](DeformingSolid& self, Body& body, const BodyDelta& delta, State& state) {
            update(self, body, delta, state, true);
          },
          py::arg("body"), py::arg("delta"), py::arg("state"),
          "Updates the solid and state after a change of the body, delta. New nodes take the motion of the old nodes\n"
          "around them, and their donors' material; momentum of each component is restored. Raises InputError where\n"
          "delta is not the body's last change, or changes before it were not followed.")
      .def(
          "update_nodes",
          [](DeformingSolid& self, Body& body, const BodyDelta& delta, State& state) {
            update(self, body, delta, state, false);
          },
          py::arg("body"), py::arg("delta"), py::arg("state"),
          "First half of update(), after each of several changes; update_points() must follow.")
      .def("update_points", &update_points, py::arg("body"), py::arg("state"),
           "Second half of update(), once after several changes. Raises InputError.")
      .def("hold", &hold, py::arg("body"), py::arg("boxes"),
           "Holds the material in boxes: it follows the rigid motion of the nodes in its box, for steps that fix\n"
           "these nodes. boxes: (k, 6) rows of x0, y0, z0, x1, y1, z1 in material coordinates; np.empty((0, 6)):\n"
           "none. They replace those of the last call. A box without four nodes that span a tetrahedron, and any\n"
           "box with 'mueller04', holds its nodes only. Raises InputError where a box has a negative side, and\n"
           "where changes of the body were not followed.")
      .def("update_graph", &update_graph, py::arg("graph"), py::arg("donors"), py::arg("updated"), py::arg("state"),
           "As update(), of a solid that was made of a graph. donors: (new,) for each new node, which come last, an "
           "old\n"
           "node. updated: nodes whose neighbours changed. Raises InputError.");
}

}  // namespace

void require_points(const DeformingSolid& solid) {
  if (solid.points_due) throw geo::InputError("the solid was updated by update_nodes(); call update_points() first");
}

void require_fit(const DeformingSolid& solid, const State& state) {
  require_points(solid);
  require_size(solid, state);
}

void bind_solid(py::module_& module) {
  Solids solid(module, "DeformingSolid", solid_doc);
  add_construction(solid);
  add_fields(solid);
  add_steps(solid);
  solid
      .def(
          "__len__", [](DeformingSolid& self) { return self.solid.size(); }, "Number of nodes.")
      .def_property_readonly("mass", &masses, "Lumped mass of each node, (n,) float64, kg.")
      .def_property_readonly(
          "materials",
          [](DeformingSolid& self) {
            const Reading reading(self.busy);
            return self.solid.materials();
          },
          "The materials, a copy.")
      .def_property_readonly(
          "point_count",
          [](DeformingSolid& self) {
            const Reading reading(self.busy);
            return self.solid.point_count();
          },
          "Number of material points.")
      .def_property_readonly(
          "point_positions",
          [](DeformingSolid& self) {
            const Reading reading(self.busy);
            return moved_points(self.solid.point_positions());
          },
          "Material coordinates of the material points, (points, 3) float64.")
      .def_property_readonly(
          "moment_quality_counts", &quality,
          "Numbers of nodes and points by the quality of their moment matrix (well-conditioned, ill-conditioned,\n"
          "singular), and of points with widened support: a dict of nodes, points, widened.")
      .def(
          "rest",
          [](DeformingSolid& self) {
            const Reading reading(self.busy);
            const std::vector<geo::Vec3> zero(self.solid.size(), geo::Vec3::Zero());
            return std::make_shared<State>(geo::State{zero, zero});
          },
          "A State of this solid, undeformed and at rest.");
}

}  // namespace kerf_python
