// Scene: its source, and overrides by keywords.
#include "scene.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "arguments.h"
#include "bind.h"
#include "gil.h"
#include "kerf/error.h"
#include "pose.h"

namespace kerf_python {
namespace {

// Keywords by the table of the scene that has their key (docs/formats.md). Keys that two tables
// have are left to `set`.
const std::map<std::string, std::string>& keywords() {
  static const auto known = [] {
    const std::pair<const char*, std::vector<const char*>> tables[] = {
        {"material.",
         {"model", "young", "poisson", "density", "volume_term", "damping", "viscosity", "discretisation",
          "mode_penalty", "yield", "creep", "most_plastic"}},
        {"body.",
         {"mesh", "spacing", "spacing_percent", "nodes", "levels", "across", "k", "scale", "refine", "velocity",
          "spin"}},
        {"time.", {"frames", "frame_rate", "step", "accuracy", "checkpoint_every", "integrator", "seed"}},
        {"fracture.",
         {"strength", "toughness", "variation", "grain", "speed", "branching", "apart", "cracks", "cracks_per_step",
          "start"}},
        {"", {"gravity"}}};
    std::map<std::string, std::string> out;
    for (const auto& [table, keys] : tables)
      for (const std::string key : keys) out[key] = table + key;
    out["yield_"] = "material.yield";
    out["max_plastic"] = "material.most_plastic";
    out["self_contact"] = "contact.self";
    return out;
  }();
  return known;
}

// A Python value as TOML writes it.
std::string toml_of(py::handle value, const std::string& key, int depth = 0) {
  const auto refuse = [&]() -> std::string {
    throw geo::InputError(key + ": give a number, a truth value, text, or a list of them");
  };
  if (depth > 4) return refuse();
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return py::module_::import("json").attr("dumps")(value).cast<std::string>();
  if (py::isinstance<py::int_>(value)) return py::str(value).cast<std::string>();
  if (py::isinstance<py::float_>(value)) {
    const double number = value.cast<double>();
    if (!std::isfinite(number)) throw geo::InputError(key + ": is not finite; correct it");
    return py::repr(py::float_(number)).cast<std::string>();
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string out = "[";
    for (const auto item : value) out += (out.size() > 1 ? ", " : "") + toml_of(item, key, depth + 1);
    return out + "]";
  }
  if (py::hasattr(value, "__fspath__")) return toml_of(py::module_::import("os").attr("fspath")(value), key);
  if (py::hasattr(value, "tolist")) {
    const py::object plain = value.attr("tolist")();
    if (!py::hasattr(plain, "tolist")) return toml_of(plain, key, depth + 1);
  }
  return refuse();
}

// Paths in overrides are relative to the current folder, not to the scene.
std::string absolute_path(const std::string& key, const std::string& text) {
  const std::string last = key.substr(key.find_last_of('.') + 1);
  if (last != "mesh" && last != "motion" && last != "file") return text;
  return py::module_::import("json").attr("dumps")(std::filesystem::absolute(text).string()).cast<std::string>();
}

std::string override_of(const std::string& key, py::handle value, bool literal) {
  if (!is_path(value)) return toml_of(value, key);
  const auto text = py::str(py::module_::import("os").attr("fspath")(value)).cast<std::string>();
  const auto path = absolute_path(key, text);
  return path == text && !literal ? toml_of(py::str(text), key) : path;
}

// Empty where it does not exist any more.
std::filesystem::path current_folder() {
  std::error_code error;
  return std::filesystem::current_path(error);
}

std::shared_ptr<const Scene> parsed(std::string text, std::string name, std::string folder, geo::SceneOverrides o) {
  const GilRelease release;
  return std::make_shared<const Scene>(std::move(text), std::move(name), std::move(folder), std::move(o));
}

}  // namespace

Scene::Scene(std::string t, std::string n, std::string f, geo::SceneOverrides o)
    : text(std::move(t)), name(std::move(n)), folder(std::move(f)), place(current_folder()), overrides(std::move(o)) {
  scene = geo::parse_scene(text, name, overrides, folder);
  for (auto& body : scene.bodies)
    if (const std::filesystem::path mesh = body.mesh; mesh.is_relative())
      body.mesh = (std::filesystem::path(folder) / mesh).string();
}

geo::SceneOverrides overrides_from(py::handle set, const py::kwargs& keys) {
  geo::SceneOverrides out;
  if (!set.is_none()) {
    if (!py::isinstance<py::dict>(set)) throw py::type_error("set: give a dict of keys, such as 'blade.0.thickness'");
    for (const auto& [key, value] : set.cast<py::dict>()) {
      if (!py::isinstance<py::str>(key)) throw py::type_error("set: keys are text, such as 'blade.0.thickness'");
      const auto name = key.cast<std::string>();
      if (name.empty()) throw geo::InputError("set: a key is empty; give one such as 'blade.0.thickness'");
      out.push_back({name, override_of(name, value, true)});
    }
  }
  for (const auto& [key, value] : keys) {
    const auto name = key.cast<std::string>();
    const auto at = keywords().find(name);
    if (at == keywords().end()) {
      std::vector<std::string> known;
      for (const auto& [word, dotted] : keywords()) known.push_back(word);
      const auto meant = geo::did_you_mean(name, known);
      throw geo::InputError("unknown key '" + name + "'" +
                            (meant.empty() ? "; give keys of blades, grips and contact by set={...}" : meant));
    }
    out.push_back({at->second, override_of(at->second, value, false)});
  }
  return out;
}

std::shared_ptr<const Scene> scene_argument(py::handle object, geo::SceneOverrides overrides) {
  if (py::isinstance<Scene>(object)) {
    auto scene = object.cast<std::shared_ptr<Scene>>();
    if (overrides.empty()) return scene;
    auto all = scene->overrides;
    all.insert(all.end(), overrides.begin(), overrides.end());
    return parsed(scene->text, scene->name, scene->folder, std::move(all));
  }
  if (!is_path(object)) throw py::type_error("scene: give a kerf.Scene, the path of a file, or its text");
  if (py::isinstance<py::str>(object))
    if (auto text = object.cast<std::string>(); text.find('\n') != text.npos)
      return parsed(std::move(text), "scene", "", std::move(overrides));
  auto path = path_from(object, "scene");
  auto text = geo::read_all(path);
  const auto folder = std::filesystem::path(path).parent_path().string();
  return parsed(std::move(text), std::move(path), folder, std::move(overrides));
}

py::array keys_to(const geo::Motion& motion) {
  std::vector<std::array<double, 8>> rows;
  for (const auto& k : motion.keys)
    rows.push_back(
        {k.time, k.position.x(), k.position.y(), k.position.z(), k.axis.x(), k.axis.y(), k.axis.z(), k.angle});
  return moved<double>(std::move(rows), {8});
}

geo::Motion keys_from(py::handle object, const std::string& name) {
  const auto [shape, values] = values_from(object, name, 2, 2);
  if (shape[1] != 8) throw geo::InputError(name + ": give rows of time, x, y, z, ax, ay, az, degrees");
  geo::Motion motion;
  for (std::size_t i = 0; i < shape[0]; ++i) {
    const double* v = &values[8 * i];
    motion.keys.push_back({v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6]}, v[7]});
    if (!(motion.keys.back().axis.norm() > 0)) throw geo::InputError(name + ": a key has no axis");
    if (i > 0 && !(motion.keys[i].time > motion.keys[i - 1].time))
      throw geo::InputError(name + ": keys must ascend in time");
  }
  return motion;
}

namespace {

constexpr const char* scene_doc =
    "A scene: bodies and their materials, blades, grips, obstacles, fracture, contact, time. It never changes.\n\n"
    "Scene(source, *, set=None, **keys): source: path of a TOML file, or a text of several lines (docs/formats.md "
    "lists\n"
    "the keys). set: a dict of dotted keys and values that replace those of the source, as\n"
    "{'blade.0.thickness': '0.1'}: text is TOML. keys: the keys of [material], [body], [time], [fracture] and gravity "
    "by\n"
    "their own names, as young=8e4. Raises InputError, with line and column.";

using Class = py::class_<Scene, std::shared_ptr<Scene>>;

template <class T>
void field(Class& scene, const char* name, T geo::Scene::*member, const char* doc) {
  scene.def_property_readonly(
      name,
      [member](const Scene& self) -> py::object {
        if constexpr (std::is_same_v<T, geo::Vec3>)
          return point(self.scene.*member);
        else
          return py::cast(self.scene.*member);
      },
      doc);
}

void add_fields(Class& scene) {
  field(scene, "bodies", &geo::Scene::bodies, "The bodies, list of SceneBody.");
  field(scene, "k", &geo::Scene::k, "Neighbours of a node.");
  field(scene, "material", &geo::Scene::material, "Material of bodies without one of their own.");
  field(scene, "grips", &geo::Scene::grips, "Boxes whose nodes are held, list of Grip.");
  field(scene, "loads", &geo::Scene::loads, "Forces over area on the skin, list of Load.");
  field(scene, "supports", &geo::Scene::supports, "Where the skin is held along axes, list of Support.");
  field(scene, "blades", &geo::Scene::blades, "Blades, list of Blade.");
  field(scene, "obstacles", &geo::Scene::obstacles, "Rigid obstacles, list of SceneObstacle.");
  field(scene, "ground", &geo::Scene::ground, "Whether there is a ground plane.");
  field(scene, "ground_point", &geo::Scene::ground_point, "A point of the ground, (3,).");
  field(scene, "ground_normal", &geo::Scene::ground_normal, "Normal of the ground, (3,).");
  field(scene, "ground_stiffness", &geo::Scene::ground_stiffness, "Acceleration per depth, 1/s2; 0: derived.");
  field(scene, "friction", &geo::Scene::friction, "Coulomb's coefficient of the ground.");
  field(scene, "gravity", &geo::Scene::gravity, "Acceleration, (3,), model units per s2.");
  field(scene, "frame_rate", &geo::Scene::frame_rate, "Frames per second.");
  field(scene, "dt", &geo::Scene::dt, "Largest time step, s.");
  field(scene, "accuracy", &geo::Scene::accuracy, "Of displacements in an implicit step, in node spacings.");
  field(scene, "frames", &geo::Scene::frames, "Length of the run, frames.");
  field(scene, "checkpoint_every", &geo::Scene::checkpoint_every, "Frames between two checkpoints.");
  field(scene, "implicit", &geo::Scene::implicit, "Whether steps are implicit; else leapfrog.");
  field(scene, "seed", &geo::Scene::seed, "Seed of sampling and jitter.");
  field(scene, "fracture", &geo::Scene::fracture, "Fracture by stress, FractureOptions.");
  field(scene, "self_contact", &geo::Scene::self_contact, "Whether bodies touch each other and themselves.");
  field(scene, "contact", &geo::Scene::contact, "Parameters of self-contact, ContactOptions.");
  field(scene, "fingerprint", &geo::Scene::fingerprint, "Hash of all that decides what a run computes.");
}

}  // namespace

void bind_scene(py::module_& module) {
  bind_scene_objects(module);
  Class scene(module, "Scene", scene_doc);
  const auto make = [](py::object source, py::object set, const py::kwargs& keys) {
    return std::make_shared<Scene>(*scene_argument(source, overrides_from(set, keys)));
  };
  scene.def(py::init(make), py::arg("source"), py::kw_only(), py::arg("set") = py::none(), "See the class.");
  add_fields(scene);
  scene.def_readonly("text", &Scene::text, "The source.")
      .def_property_readonly(
          "steps_per_frame", [](const Scene& self) { return self.scene.steps_per_frame(); },
          "Equal time steps in a frame: the fewest that are at most dt long.")
      .def_property_readonly(
          "integrator", [](const Scene& self) { return self.scene.integrator(); },
          "The value of time.integrator: 'implicit', 'bossak' or 'leapfrog'.")
      .def_readonly("name", &Scene::name, "The path, or 'scene'.")
      .def("__repr__", [](const Scene& self) {
        return "<kerf.Scene " + self.name + " of " + std::to_string(self.scene.bodies.size()) + " bodies and " +
               std::to_string(self.scene.blades.size()) + " blades>";
      });
  module.def(
      "parse_motion",
      [](const std::string& text, const std::string& name) {
        geo::Motion motion;
        motion.keys = geo::parse_motion(text, name);
        return keys_to(motion);
      },
      py::arg("text"), py::arg("name") = "motion",
      "Keyframes of a table of time, position, axis and degrees on each line: (k, 8) float64. Raises InputError.");
}

}  // namespace kerf_python
