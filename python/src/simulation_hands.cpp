// Blades, springs, stitches and grips that a program adds to a run, changes of its values, and the
// recording.
#include <pybind11/stl.h>

#include <filesystem>

#include "arguments.h"
#include "bind.h"
#include "kerf/files.h"
#include "keywords.h"
#include "pose.h"
#include "simulation_handle.h"

namespace kerf_python {
namespace {

using Class = py::class_<Simulation, std::shared_ptr<Simulation>>;

// Adds an object, and gives it a handle. `add` returns its index.
template <Kind kind, class Add>
Handle<kind> added(Simulation& self, const Add& add) {
  const Writing writing(self.busy);
  const auto index = add(self.run());
  self.acted = true;
  return {self.shared_from_this(), index};
}

Handle<Kind::blade> add_blade(Simulation& self, py::object points, py::object pose, const py::kwargs& options) {
  geo::Blade blade;
  blade.points = points_from(points, "points");
  const auto at = pose_from(pose, "pose");
  Keywords keywords(options, "add_blade");
  keywords.flag("closed", blade.closed);
  keywords.take("thickness", blade.thickness, 0, 1e9);
  keywords.take("stiffness", blade.stiffness, 0, 1e12);
  keywords.take("friction", blade.friction, 0, 10);
  keywords.take("resistance", blade.resistance, 0, 1e12);
  keywords.take("limit", blade.limit, 1e-3, 1e9);
  if (const auto back = keywords.object("back"); !back.is_none()) blade.back = point_from(back, "back");
  if (const auto name = keywords.object("name"); !name.is_none()) blade.name = py::str(name).cast<std::string>();
  keywords.finish();
  if (blade.thickness > 0 && !(blade.back.norm() > 0))
    throw geo::InputError("back: a blade with thickness needs the vector from its edge to its back");
  return added<Kind::blade>(self, [&](geo::Simulation& run) {
    if (blade.name.empty()) blade.name = "blade" + std::to_string(run.scene().blades.size() + 1);
    return run.add_blade(std::move(blade), at).index();
  });
}

Handle<Kind::grip> add_grip(Simulation& self, py::object lo, py::object hi) {
  geo::Grip grip;
  grip.lo = point_from(lo, "lo");
  grip.hi = point_from(hi, "hi");
  if (!(grip.lo.array() <= grip.hi.array()).all()) throw geo::InputError("lo: a corner is above that of hi");
  return added<Kind::grip>(self, [&](geo::Simulation& run) { return run.add_grip(std::move(grip)).index(); });
}

// The number of a node of the run, or None.
std::optional<std::uint32_t> node_from(Simulation& self, const py::object& node, const char* name) {
  if (node.is_none()) return std::nullopt;
  const auto index = integer_from(node, name);
  const Reading reading(self.busy);
  const auto nodes = static_cast<std::int64_t>(self.run().body().nodes.size());
  if (index < 0 || index >= nodes)
    throw geo::InputError(std::string(name) + ": give a number from 0 to " + std::to_string(nodes - 1));
  return static_cast<std::uint32_t>(index);
}

Handle<Kind::pull> add_pull(Simulation& self, py::object at, py::object to, double stiffness, py::object node) {
  geo::Pull pull;
  pull.point = point_from(at, "point");
  pull.stiffness = stiffness;
  const auto end = point_from(to, "to");
  if (!(stiffness >= 0 && stiffness <= 1e15)) throw geo::InputError("stiffness: give a number from 0 to 1e15");
  pull.node = node_from(self, node, "node");
  return added<Kind::pull>(self, [&](geo::Simulation& run) { return run.add_pull(std::move(pull), end).index(); });
}

Handle<Kind::stitch> add_stitch(Simulation& self, py::object a, py::object b, const py::kwargs& options) {
  geo::Stitch stitch;
  stitch.ends[0].point = point_from(a, "a");
  stitch.ends[1].point = point_from(b, "b");
  Keywords keywords(options, "add_stitch");
  keywords.take("stiffness", stitch.stiffness, 0, 1e15);
  keywords.take("length", stitch.length, 0, 1e9);
  keywords.take("closing", stitch.closing, 0, 1e9);
  stitch.ends[0].node = node_from(self, keywords.object("node_a"), "node_a");
  stitch.ends[1].node = node_from(self, keywords.object("node_b"), "node_b");
  keywords.finish();
  return added<Kind::stitch>(self, [&](geo::Simulation& run) { return run.add_stitch(stitch).index(); });
}

void end_stitch(const Handle<Kind::stitch>& handle) {
  const Writing writing(handle.simulation->busy);
  handle.simulation->run().stitch(handle.index).end();
  handle.simulation->acted = true;
}

void extend(const Handle<Kind::pull>& handle, py::object to) {
  const auto position = point_from(to, "to");
  const Writing writing(handle.simulation->busy);
  auto& run = handle.simulation->run();
  require_present_end(scene_object(handle).motion, run.state(), "pull");
  run.pull(handle.index).drive_to(position);
}

void change(Simulation& self, const py::kwargs& values) {
  geo::SceneChange changes;
  Keywords keywords(values, "change");
  const auto take = [&](const char* name, std::optional<double>& out) {
    double value = std::numeric_limits<double>::quiet_NaN();
    keywords.take(name, value);
    if (!std::isnan(value)) out = value;
  };
  take("young", changes.young);
  take("damping", changes.damping);
  take("friction", changes.friction);
  take("accuracy", changes.accuracy);
  take("step", changes.dt);
  if (const auto gravity = keywords.object("gravity"); !gravity.is_none())
    changes.gravity = point_from(gravity, "gravity");
  keywords.finish();
  const Writing writing(self.busy);
  self.run().change(changes);
  self.acted = true;
}

void strike(Simulation& self, py::object point, int cells) {
  const geo::Vec3 at = point_from(point, "point");
  if (cells < 2 || cells > 1000) throw geo::InputError("cells: give a number from 2 to 1000");
  const Writing writing(self.busy);
  without_gil([&] { self.run().strike({.point = at, .cells = cells}); });
  self.acted = true;
}

void write_recording(Simulation& self, const Path& path) {
  const Reading reading(self.busy);
  geo::require_writable(path);
  without_gil([&] {
    const auto folder = std::filesystem::absolute(path.text).parent_path().string();
    const auto scene = self.recording();
    geo::write_all(path, [&](std::ostream& out) { geo::write_scene(out, scene, folder); });
  });
}

void bind_pull_handle(py::module_& module) {
  using Pull = Handle<Kind::pull>;
  // Reads the pull while the run is not changed.
  const auto reads = [](auto read) {
    return [read](const Pull& handle) {
      const Reading reading(handle.simulation->busy);
      return read(scene_object(handle));
    };
  };
  py::class_<Pull>(module, "PullHandle", "A spring of a run; see Simulation.add_pull().")
      .def_readonly("index", &Pull::index, "Its number in the run.")
      .def_property_readonly("point", reads([](const geo::Pull& p) { return point(p.point); }),
                             "Where it holds the body, (3,) float64, material coordinates.")
      .def_property_readonly("node", reads([](const geo::Pull& p) { return p.node; }),
                             "The node whose neighbourhood it holds, or None: the nearest.")
      .def_property_readonly("stiffness", reads([](const geo::Pull& p) { return p.stiffness; }),
                             "Force over stretch, N/m.")
      .def_property_readonly("keys", reads([](const geo::Pull& p) { return keys_to(p.motion); }),
                             "Keyframes of the other end, (k, 8): time, x, y, z, axis, degrees.")
      .def_property_readonly(
          "force",
          [](const Pull& handle) {
            const Reading reading(handle.simulation->busy);
            return last_force(handle.simulation->last.pull_force, handle.index);
          },
          "Mean force of the material on it in the last frame, (3,) float64, N.")
      .def("extend", &extend, py::arg("to"),
           "Moves the other end to this world position by the end of the next frame. The spring is removed after that\n"
           "frame unless this is called again. Raises InputError where it does not exist now.");
}

void bind_stitch_handle(py::module_& module) {
  using Stitch = Handle<Kind::stitch>;
  py::class_<Stitch>(module, "StitchHandle", "A thread of a run; see Simulation.add_stitch().")
      .def_readonly("index", &Stitch::index, "Its number in the run.")
      .def_property_readonly(
          "force",
          [](const Stitch& handle) {
            const Reading reading(handle.simulation->busy);
            const std::vector<double>& all = handle.simulation->last.stitch_force;
            return handle.index < all.size() ? all[handle.index] : 0.0;
          },
          "Mean tension in the last frame, N.")
      .def("end", &end_stitch, "Cuts the thread now.");
}

constexpr const char* add_blade_doc =
    "Adds a blade at a pose, which BladeHandle.extend() moves. points: its edge, (n, 3), in the blade's coordinates. "
    "pose:\n"
    "a position; a pair of position and quaternion (w, x, y, z); or a rigid 4 x 4 matrix. Keywords as in a scene:\n"
    "closed, back, thickness, stiffness, friction, resistance, limit, name. Raises InputError.";
constexpr const char* add_pull_doc =
    "Adds a spring between a point of the material and a world position, which PullHandle.extend() moves. point: in\n"
    "material coordinates. stiffness: N/m. node: one that sees the point; None: the nearest. Raises InputError.";
constexpr const char* add_stitch_doc =
    "Sews two points of the material, a and b, (3,), material coordinates, to each other: a thread that bears tension\n"
    "alone. Keywords: length, which it has in the end, 0; closing, s in which it is drawn to it from the distance of\n"
    "now, 0; stiffness, N/m, 100; node_a, node_b: nodes that see the points, None: the nearest. Raises InputError.";
constexpr const char* change_doc =
    "Changes values from now on: young, Pa; damping, 1/s; friction; gravity, (3,), model units per s2; accuracy, node\n"
    "spacings; step, the largest time step, s, from the next frame on. Raises InputError.";
constexpr const char* write_recording_doc =
    "Writes the scene with all that was added and changed so far (.toml). A new run of it has the same frames, byte "
    "for\n"
    "byte; so has kerf-sim, where the models are the files that the scene names. Raises InputError after move(), "
    "which\n"
    "replaces keyframes, and in a run from resume(). Raises OutputError.";

}  // namespace

void require_present_end(const geo::Motion& motion, const geo::RunState& now, const char* what) {
  if (!motion.keys.empty() && motion.keys.back().time > now.time)
    throw geo::InputError(std::string("the ") + what + " has a key later than now: call step() first");
  if (motion.keys.empty() || motion.keys.back().time != now.time)
    throw geo::InputError(std::string("the ") + what + " does not exist now: it ends with its last key; add another");
}

void add_hands(py::module_& module, Class& simulation) {
  bind_pull_handle(module);
  bind_stitch_handle(module);
  simulation.def("add_blade", &add_blade, py::arg("points"), py::arg("pose"), add_blade_doc)
      .def("add_grip", &add_grip, py::arg("lo"), py::arg("hi"),
           "Holds the material in a box from now on, until GripHandle.end(). lo, hi: its corners, (3,), material\n"
           "coordinates. Raises InputError.")
      .def("add_pull", &add_pull, py::arg("point"), py::arg("to"), py::kw_only(), py::arg("stiffness") = 100.0,
           py::arg("node") = py::none(), add_pull_doc)
      .def("add_stitch", &add_stitch, py::arg("a"), py::arg("b"), add_stitch_doc)
      .def("strike", &strike, py::arg("point"), py::kw_only(), py::arg("cells") = 12,
           "Breaks the piece of the surface nearest to a point, (3,), world, into about so many cells, small near it.\n"
           "Its parts fly from the point. Raises InputError where a blade is in the body, GeometryError where the "
           "piece\n"
           "does not break; the run is then as it was.")
      .def("change", &change, change_doc)
      .def("write_recording", &write_recording, py::arg("path"), write_recording_doc);
}

}  // namespace kerf_python
