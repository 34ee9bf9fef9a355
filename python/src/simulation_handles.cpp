// Blades, grips and obstacles of a run, which Python moves.
#include <pybind11/stl.h>

#include "arguments.h"
#include "bind.h"
#include "kerf/error.h"
#include "pose.h"
#include "simulation_handle.h"

namespace kerf_python {
namespace {

using Class = py::class_<Simulation, std::shared_ptr<Simulation>>;

constexpr const char* kind_names[] = {"blade", "grip", "obstacle"};

template <Kind kind>
std::size_t index_of(const geo::Scene& scene, py::handle which) {
  const auto& objects = objects_of<kind>(scene);
  const std::string word = kind_names[static_cast<int>(kind)];
  if (py::isinstance<py::str>(which)) {
    std::vector<std::string> names;
    if constexpr (kind != Kind::grip)
      for (const auto& object : objects) names.push_back(object.name);
    const auto name = which.cast<std::string>();
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return i;
    throw geo::InputError("the scene has no " + word + " '" + name + "'" + geo::did_you_mean(name, names));
  }
  const auto index = integer_from(which, word);
  if (index < 0 || static_cast<std::size_t>(index) >= objects.size())
    throw geo::InputError(word + " " + std::to_string(index) + ": the scene has " + std::to_string(objects.size()));
  return static_cast<std::size_t>(index);
}

template <Kind kind>
void move(const Handle<kind>& handle, py::object to) {
  const auto pose = pose_from(to, "pose");
  auto& self = *handle.simulation;
  const Writing writing(self.busy);
  self.unrecordable =
      "move() was called, which a recording cannot hold; give the scene keyframes, or use add_blade() and extend()";
  if constexpr (kind == Kind::blade)
    self.run().blade(handle.index).drive_to(pose);
  else if constexpr (kind == Kind::grip)
    self.run().grip(handle.index).drive_to(pose);
  else
    self.run().obstacle(handle.index).drive_to(pose);
}

template <Kind kind>
py::class_<Handle<kind>> bind_handle(py::module_& module, const char* name, const char* doc, const char* move_doc) {
  py::class_<Handle<kind>> handle(module, name, doc);
  handle.def("move", &move<kind>, py::arg("pose"), move_doc)
      .def_readonly("index", &Handle<kind>::index, "Its number in the scene.")
      .def_property_readonly(
          "pose",
          [](const Handle<kind>& h) {
            const Reading reading(h.simulation->busy);
            return pose_to(scene_object(h).motion.at(h.simulation->run().state().time));
          },
          "Its pose now: position and quaternion (w, x, y, z), relative as in the scene's motions.")
      .def_property_readonly(
          "keys",
          [](const Handle<kind>& h) {
            const Reading reading(h.simulation->busy);
            return keys_to(scene_object(h).motion);
          },
          "Its keyframes, (k, 8): time, x, y, z, axis, degrees; as move() or extend() has set them.");
  if constexpr (kind != Kind::grip)
    handle.def_property_readonly(
        "name",
        [](const Handle<kind>& h) {
          const Reading reading(h.simulation->busy);
          return scene_object(h).name;
        },
        "Its name in the scene.");
  return handle;
}

template <Kind kind>
void add_access(Class& simulation, const char* doc) {
  simulation.def(
      kind_names[static_cast<int>(kind)],
      [](Simulation& self, py::object which) {
        const Reading reading(self.busy);
        return Handle<kind>{self.shared_from_this(), index_of<kind>(self.run().scene(), which)};
      },
      py::arg("which"), doc);
}

// The keyframes of all objects, as Simulation.resume() takes them.
py::dict motions_of(Simulation& self) {
  const Reading reading(self.busy);
  const auto& scene = self.run().scene();
  py::dict out;
  const auto add = [&](const char* kind, const auto& objects) {
    for (std::size_t i = 0; i < objects.size(); ++i)
      if (!objects[i].motion.keys.empty())
        out[py::str(std::string(kind) + "." + std::to_string(i))] = keys_to(objects[i].motion);
  };
  add("blade", scene.blades);
  add("grip", scene.grips);
  add("obstacle", scene.obstacles);
  return out;
}

void extend(const Handle<Kind::blade>& handle, py::object to) {
  const auto pose = pose_from(to, "pose");
  const Writing writing(handle.simulation->busy);
  handle.simulation->acted = true;
  auto& run = handle.simulation->run();
  require_present_end(scene_object(handle).motion, run.state(), "blade");
  run.blade(handle.index).drive_to(pose);
}

void end(const Handle<Kind::grip>& handle) {
  const Writing writing(handle.simulation->busy);
  handle.simulation->acted = true;
  handle.simulation->run().grip(handle.index).end();
}

// A force that is zero by definition is no measurement.
void warn_of_sharp(const geo::Blade& blade) {
  if ((blade.thickness > 0 && !blade.back.isZero()) || blade.resistance > 0) return;
  const std::string text =
      "blade '" + blade.name + "' has no force: without a resistance, or back and thickness, it is ideally sharp";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

constexpr const char* extend_blade_doc =
    "Moves a blade that add_blade() made to this pose by the end of the next frame; it cuts on its way, and is "
    "removed\n"
    "after that frame unless this is called again. It keeps the keyframes, so that write_recording() holds the whole\n"
    "motion. pose: as for move(). Raises InputError where the blade does not exist now.";
constexpr const char* move_blade_doc =
    "Moves it from its present pose to this one by the end of the next frame; it cuts on its way, and is removed "
    "after\n"
    "that frame unless it is moved again. pose: a position; a pair of position and quaternion (w, x, y, z); or a "
    "rigid\n"
    "4 x 4 matrix. Raises InputError.";
constexpr const char* move_other_doc =
    "Moves it from its present pose to this one by the end of the next frame, where it stays. pose: a position; a "
    "pair\n"
    "of position and quaternion (w, x, y, z); or a rigid 4 x 4 matrix. Raises InputError.";

}  // namespace

void add_handles(py::module_& module, Class& simulation) {
  bind_handle<Kind::blade>(module, "BladeHandle", "A blade of a run; see Simulation.blade().", move_blade_doc)
      .def_property_readonly(
          "points",
          [](const Handle<Kind::blade>& h) {
            const Reading reading(h.simulation->busy);
            return moved_points(scene_object(h).at(h.simulation->run().state().time));
          },
          "World positions of its edge now, (n, 3) float64.")
      .def("extend", &extend, py::arg("pose"), extend_blade_doc)
      .def_property_readonly(
          "force",
          [](const Handle<Kind::blade>& h) {
            const Reading reading(h.simulation->busy);
            warn_of_sharp(scene_object(h));
            return last_force(h.simulation->last.blade_force, h.index);
          },
          "Mean force of the material on the blade's wedge in the last frame, (3,) float64, N. A blade without `back` "
          "and\n"
          "`thickness` is ideally sharp: it parts the material without a resistance, and the force is zero, which a\n"
          "UserWarning says.");
  bind_handle<Kind::grip>(module, "GripHandle", "A grip of a run; see Simulation.grip().", move_other_doc)
      .def("end", &end, "Lets go, from now on.");
  bind_handle<Kind::obstacle>(module, "ObstacleHandle", "An obstacle of a run; see Simulation.obstacle().",
                              move_other_doc);
  add_access<Kind::blade>(simulation, "The blade of this name or number. Raises InputError.");
  add_access<Kind::grip>(simulation, "The grip of this number. Raises InputError.");
  add_access<Kind::obstacle>(simulation, "The obstacle of this name or number. Raises InputError.");
  simulation.def_property_readonly(
      "motions", &motions_of,
      "Keyframes of blades, grips and obstacles as move() has set them: a dict such as {'blade.0': (k, 8) rows}.");
}

}  // namespace kerf_python
