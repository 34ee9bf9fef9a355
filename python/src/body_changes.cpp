// Splits and other changes of a body, and their reports.
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "bind.h"
#include "body.h"
#include "complex.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "options.h"
#include "progress.h"

namespace kerf_python {
namespace {

std::vector<geo::Vec3> positions_of(const geo::FrontState& front) {
  std::vector<geo::Vec3> out;
  for (const auto& point : front.points) out.push_back(point.position);
  return out;
}

BodyFront begun(Body& self, py::object line, bool closed, const std::string& name) {
  const auto points = points_from(line, "line");
  const Writing writing(self.busy);
  BodyFront front{self.shared_from_this(), geo::begin_front(points, closed, self.unused_crack())};
  front.state.name = name;
  return front;
}

geo::CrackOptions options_from(const py::kwargs& given) {
  Keywords keywords(given, "split");
  const auto options = crack_options(keywords);
  keywords.finish();
  return options;
}

// A step of the front; its points are resampled where their number differs.
BodyDelta split(Body& self, BodyFront& front, py::object next, const geo::CrackOptions& options) {
  if (front.body.get() != &self) throw geo::InputError("front: belongs to another body; begin one with Body.front()");
  auto points = points_from(next, "next");
  const Writing writing(self.busy);
  if (points.size() < 2) throw geo::InputError("next: give two points at least");
  points = geo::resample_front(positions_of(front.state), points, front.state.closed);
  BodyDelta out;
  {
    const GilRelease release;
    out.delta = geo::split(self.body, front.state, points, options, &out.stats);
  }
  self.changed();
  out.body = self.id;
  out.version = self.version;
  return out;
}

// The change is made to a copy: an interruption leaves the body as it was.
BodyDelta update(Body& self, const geo::Complex& surface, py::object progress) {
  ProgressReport report(std::move(progress));
  const Writing writing(self.busy);
  BodyDelta out;
  auto after = report.run([&](geo::Progress p) {
    geo::Body next = self.body;
    out.delta = geo::update_body(next, surface, &out.stats, p);
    return next;
  });
  self.body = std::move(after);
  self.changed();
  out.body = self.id;
  out.version = self.version;
  return out;
}

BodyDelta resize(Body& self, py::object nodes, py::object radii) {
  const Writing writing(self.busy);
  const auto ids = integers_from(nodes, "nodes", 0, static_cast<std::int64_t>(self.body.nodes.size()) - 1);
  const auto values = numbers_from(radii, "radii");
  if (ids.size() != values.size())
    throw geo::InputError("radii: " + std::to_string(values.size()) + " values for " + std::to_string(ids.size()) +
                          " nodes; give one per node");
  std::vector<std::pair<geo::NodeId, double>> changes;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!(values[i] > 0 && values[i] <= self.body.widest_radius))
      throw geo::InputError("radii: value at " + std::to_string(i) + " is not above 0 and at most widest_radius");
    changes.push_back({geo::NodeId(static_cast<std::uint32_t>(ids[i])), values[i]});
  }
  std::sort(changes.begin(), changes.end());
  for (std::size_t i = 0; i + 1 < changes.size(); ++i)
    if (changes[i].first == changes[i + 1].first)
      throw geo::InputError("nodes: node " + std::to_string(changes[i].first.value) + " is given twice");
  BodyDelta out;
  {
    const GilRelease release;
    out.delta = geo::resize_nodes(self.body, changes);
  }
  self.changed();
  out.body = self.id;
  out.version = self.version;
  return out;
}

template <class Tag>
py::array ids(const std::vector<geo::Id<Tag>>& values) {
  return moved_ids(std::vector<geo::Id<Tag>>(values));
}

void bind_stats(py::module_& module) {
  py::class_<geo::CrackStats>(module, "CrackStats", "Counts and seconds of crack steps (section 5.2).")
      .def_readonly("faces_near", &geo::CrackStats::faces_near, "Pairs of a strip triangle and a near face.")
      .def_readonly("triangles_cut", &geo::CrackStats::triangles_cut, "Divided faces.")
      .def_readonly("new_crack_faces", &geo::CrackStats::new_crack_faces, "Crack faces made.")
      .def_readonly("attempts", &geo::CrackStats::attempts, "Attempts, the first one included.")
      .def_readonly("snapped", &geo::CrackStats::snapped, "Vertices that the strip was snapped to.")
      .def_readonly("repairs", &geo::CrackStats::repairs, "Attempts that removed a fault of rounding.")
      .def_property_readonly("seconds", &geo::CrackStats::seconds, "Seconds of all phases.");
  py::class_<geo::SplitStats>(module, "SplitStats", "Counts and seconds of splits (section 4).")
      .def_readonly("crack", &geo::SplitStats::crack, "Of the surface, CrackStats.")
      .def_readonly("edges_cut", &geo::SplitStats::edges_cut, "Edges of the graph that were removed.")
      .def_readonly("edges_added", &geo::SplitStats::edges_added, "Edges of the graph that were added.")
      .def_readonly("nodes_updated", &geo::SplitStats::nodes_updated, "Nodes whose rows were computed again.")
      .def_readonly("nodes_added", &geo::SplitStats::nodes_added, "New nodes.")
      .def_readonly("nodes_moved", &geo::SplitStats::nodes_moved, "Old nodes moved off a crack face.")
      .def_readonly("orphans", &geo::SplitStats::orphans, "Surface vertices that got another carrying node.")
      .def_readonly("repair_nodes", &geo::SplitStats::repair_nodes, "Of the new nodes, those in narrow passages.")
      .def_readonly("resample_seconds", &geo::SplitStats::resample_seconds, "Seconds of new nodes.")
      .def_readonly("graph_seconds", &geo::SplitStats::graph_seconds,
                    "Seconds of graph and neighbours, and of closest vertices beside them.")
      .def_readonly("binding_seconds", &geo::SplitStats::binding_seconds, "Seconds of all else of the binding.");
}

void bind_delta(py::module_& module) {
  py::class_<BodyDelta>(module, "BodyDelta", "Changes of a body by one step (section 4). Ids ascend.")
      .def_property_readonly(
          "first_new_node", [](const BodyDelta& d) { return d.delta.first_new_node.value; },
          "Nodes from here on are new.")
      .def_property_readonly(
          "donors", [](const BodyDelta& d) { return ids(d.delta.donors); },
          "For each new node: the node whose motion and material it takes, uint32.")
      .def_property_readonly(
          "moved_nodes", [](const BodyDelta& d) { return ids(d.delta.moved_nodes); },
          "Old nodes moved off a crack face, uint32.")
      .def_property_readonly(
          "resized_nodes",
          [](const BodyDelta& d) {
            std::vector<std::uint32_t> nodes;
            std::vector<double> radii;
            for (const auto& [node, radius] : d.delta.resized_nodes) {
              nodes.push_back(node.value);
              radii.push_back(radius);
            }
            return py::make_tuple(moved<std::uint32_t>(std::move(nodes)), moved<double>(std::move(radii)));
          },
          "Old nodes with another support radius, uint32, and their old radii, float64.")
      .def_property_readonly(
          "updated_nodes", [](const BodyDelta& d) { return ids(d.delta.updated_nodes); },
          "Nodes whose rows changed, uint32; new, moved and resized nodes included.")
      .def_property_readonly(
          "rebound_vertices", [](const BodyDelta& d) { return ids(d.delta.rebound_vertices); },
          "Surface vertices with another carrying node, uint32.")
      .def_property_readonly(
          "detached",
          [](const BodyDelta& d) {
            py::list out;
            for (const auto& piece : d.delta.detached) out.append(ids(piece));
            return out;
          },
          "For each piece that came off: its nodes, uint32.")
      .def_property_readonly(
          "crack",
          [](const BodyDelta& d) {
            return std::make_shared<Delta>(Delta{d.delta.crack, py::dict()});
          },
          "Changes of the complex, CrackDelta.")
      .def_readonly("stats", &BodyDelta::stats, "Counts and seconds of the step, SplitStats.")
      .def("__bool__", [](const BodyDelta& d) { return !d.delta.crack.empty() || !d.delta.updated_nodes.empty(); });
}

void bind_front(py::module_& module) {
  py::class_<BodyFront>(module, "BodyFront", "A splitting front in a body (section 5.1); see Body.front().")
      .def_property_readonly(
          "points",
          [](const BodyFront& f) {
            const Reading reading(f.body->busy);
            return moved_points(positions_of(f.state));
          },
          "Positions of the front's points, (n, 3) float64, material coordinates.")
      .def_property_readonly(
          "segments",
          [](const BodyFront& f) {
            const Reading reading(f.body->busy);
            py::list out;
            for (const auto& segment : f.state.segments) {
              std::vector<geo::Vec3> points;
              for (const auto& point : segment) points.push_back(point.position);
              out.append(moved_points(std::move(points)));
            }
            return out;
          },
          "For each segment: its ends and the contacts between them, (c, 3) float64.")
      .def_property_readonly(
          "closed", [](const BodyFront& f) { return f.state.closed; }, "Whether the last point is joined to the first.")
      .def_property_readonly(
          "crack", [](const BodyFront& f) { return f.state.crack; }, "Number of the crack behind the front.")
      .def_property_readonly(
          "name", [](const BodyFront& f) { return f.state.name; }, "As given to Body.front().")
      .def(
          "advance",
          [](BodyFront& f, py::object next, const py::kwargs& options) {
            return split(*f.body, f, std::move(next), options_from(options));
          },
          py::arg("next"), "The same as Body.split() with this front.");
}

constexpr const char* split_doc =
    "Moves a front to next through all seven steps of section 4: crack, graph, new nodes, neighbours, binding.\n\n"
    "front: from front(). next: (n, 3) points; resampled where their number differs. Options: snap, snap_edges, "
    "face_offset,\n"
    "clearance, jitter, attempts, seed, as of Complex.front(). Returns a BodyDelta. Raises InputError; GeometryError "
    "where the step is not possible: body and front are then\n"
    "unchanged.";

}  // namespace

void add_changes(py::class_<Body, std::shared_ptr<Body>>& body) {
  body.def("front", &begun, py::arg("line"), py::arg("closed") = false, py::arg("name") = "",
           "A front at line, (n, 3), material coordinates: F_0 of section 5.1. Returns a BodyFront. Raises InputError.")
      .def(
          "split",
          [](Body& self, BodyFront& front, py::object next, const py::kwargs& options) {
            return split(self, front, std::move(next), options_from(options));
          },
          py::arg("front"), py::arg("next"), split_doc)
      .def(
          "update",
          [](Body& self, py::object surface, py::object progress) {
            return update(self, subject_from(surface, "surface").complex, std::move(progress));
          },
          py::arg("surface"), py::kw_only(), py::arg("progress") = py::none(),
          "Brings the body to a surface that has grown from its own by cracks made elsewhere: steps 4 to 7 of\n"
          "section 4. surface: Complex or two-sided Mesh. Returns a BodyDelta. Raises InputError where it has not\n"
          "grown from the body's surface; the body is then unchanged.")
      .def("resize", &resize, py::arg("nodes"), py::arg("radii"),
           "Sets the support radii (section 6.4) of some nodes: (n,) ids and (n,) radii, at most widest_radius.\n"
           "Returns a BodyDelta. Raises InputError.");
}

void bind_body_changes(py::module_& module) {
  bind_stats(module);
  bind_delta(module);
  bind_front(module);
}

}  // namespace kerf_python
