// Simulation: beginning, frames, checkpoints.
#include "simulation.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "arguments.h"
#include "bind.h"
#include "kerf/appearance.h"
#include "kerf/body_file.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "progress.h"

namespace kerf_python {
namespace {

using Class = py::class_<Simulation, std::shared_ptr<Simulation>>;
using Meshes = std::vector<std::shared_ptr<const Mesh>>;

// Throws InputError unless the mesh is a valid solid without cracks; `name` stands for it.
void require_whole(geo::TriangleMesh& mesh, const std::string& name) {
  try {
    geo::require_solid(mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(name + ": " + e.what());
  }
  if (std::any_of(mesh.patch.begin(), mesh.patch.end(), [](auto patch) { return patch != 0; }))
    throw geo::InputError(name + ": is cut already; a scene begins with whole models");
  mesh.patch.clear();
  mesh.site.clear();
}

std::string bytes_of(const geo::TriangleMesh& mesh) {
  std::ostringstream out;
  geo::write_ply(out, mesh);
  return std::move(out).str();
}

Meshes meshes_from(py::handle object) {
  if (object.is_none()) return {};
  if (!py::isinstance<py::list>(object) && !py::isinstance<py::tuple>(object)) return {mesh_argument(object, "models")};
  Meshes out;
  for (const auto item : object) out.push_back(mesh_argument(item, "models"));
  return out;
}

std::shared_ptr<Simulation> begun(py::object source, py::object models, py::object set, py::object progress,
                                  const py::kwargs& keys) {
  auto scene = scene_argument(source, overrides_from(set, keys));
  const auto given = meshes_from(models);
  ProgressReport report(std::move(progress));
  return report.run(
      [&](geo::Progress p) { return std::make_shared<Simulation>(scene, models_of(scene->scene, given), p); });
}

// The motion of an object's key, such as "blade.0". Throws InputError.
geo::Motion& motion_of(geo::Scene& scene, const std::string& key) {
  const auto dot = key.find('.');
  std::size_t index = 0;
  try {
    index = static_cast<std::size_t>(std::stoul(key.substr(dot == key.npos ? 0 : dot + 1)));
    const auto kind = key.substr(0, dot);
    if (kind == "blade") return scene.blades.at(index).motion;
    if (kind == "grip") return scene.grips.at(index).motion;
    if (kind == "obstacle") return scene.obstacles.at(index).motion;
  } catch (const std::logic_error&) {
  }
  throw geo::InputError("motions: '" + key + "' names no object; give such as 'blade.0', 'grip.1', 'obstacle.0'");
}

std::shared_ptr<Simulation> resumed(const Path& path, py::object source, py::object models, py::object set,
                                    py::object motions, const py::kwargs& keys) {
  auto scene = scene_argument(source, overrides_from(set, keys));
  const auto given = meshes_from(models);
  geo::Scene moved_scene = scene->scene;
  if (!motions.is_none()) {
    if (!py::isinstance<py::dict>(motions)) throw py::type_error("motions: give what Simulation.motions has");
    for (const auto& [key, value] : motions.cast<py::dict>())
      motion_of(moved_scene, py::str(key)) = keys_from(value, "motions");
  }
  return without_gil([&] {
    return std::make_shared<Simulation>(scene, models_of(scene->scene, given), moved_scene, geo::read_all(path));
  });
}

void save(Simulation& self, const Path& path) {
  const Writing writing(self.busy);
  without_gil([&] {
    const auto bytes = self.checkpoint();
    geo::write_all(path,
                   [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
  });
  self.changed();
}

// One frame with reports of a run of `count` frames, of which `done` are complete.
geo::FrameStats frame(Simulation& self, ProgressReport& report, int done, int count) {
  const Writing writing(self.busy);
  self.changed();
  self.last = report.run([&](geo::Progress p) {
    const auto phase = "frame " + std::to_string(done + 1) + " of " + std::to_string(count);
    std::size_t all = 1;
    auto stats = self.advance([&](std::string_view, std::size_t step, std::size_t steps) {
      all = steps;
      return p(phase, static_cast<std::size_t>(done) * steps + step, static_cast<std::size_t>(count) * steps);
    });
    geo::report(p, phase, static_cast<std::size_t>(done + 1) * all, static_cast<std::size_t>(count) * all);
    return stats;
  });
  return self.last;
}

geo::FrameStats run_frames(Simulation& self, py::object frames, py::object progress, py::object each) {
  int count = 0;
  if (frames.is_none()) {
    const Reading reading(self.busy);
    count = std::max(0, self.scene->scene.frames - self.run().state().frame);
  } else {
    const auto wanted = integer_from(frames, "frames");
    if (wanted < 0 || wanted > 100000000) throw geo::InputError("frames: give a number from 0 to 100000000");
    count = static_cast<int>(wanted);
  }
  if (!each.is_none() && !PyCallable_Check(each.ptr()))
    throw py::type_error("each: give a callable of (simulation, stats)");
  ProgressReport report(std::move(progress));
  geo::FrameStats total;
  for (int i = 0; i < count; ++i) {
    const auto stats = frame(self, report, i, count);
    total += stats;
    if (each.is_none()) continue;
    const py::object answer = each(self.shared_from_this(), stats);
    if (!answer.is_none() && PyObject_Not(answer.ptr())) break;
  }
  return total;
}

constexpr const char* simulation_doc =
    "A run: bodies deform while blades cut them (section 3.3, 4). The result is the same for any number of threads, "
    "and\n"
    "the same as kerf-sim's, byte for byte.\n\n"
    "Simulation(scene, *, models=None, set=None, progress=None, **keys): scene: a Scene, a path, or a text. models: a\n"
    "Mesh, or one for each body, in place of the files that the scene names. set, keys: as for Scene, such as "
    "young=8e4.\n"
    "Raises InputError, GeometryError where a prescored crack cannot be inserted.\n\n"
    "Arrays and surfaces are snapshots: they stay as they are when the run goes on. Two calls at once raise Error.";
constexpr const char* run_doc =
    "Makes frames: this number, or up to the scene's last. each: a callable of (simulation, stats) after every frame;\n"
    "False ends the run. Returns the sum of FrameStats. A stop by progress or Ctrl-C takes effect at the end of a "
    "frame,\n"
    "so that the run can go on. Raises GeometryError where a position is no longer finite.";
constexpr const char* resume_doc =
    "Continues a run from a checkpoint, of save() or of kerf-sim. scene, models, set, keys: the same as of that run.\n"
    "motions: what Simulation.motions had, where objects were moved by hand. The frames are the same as without the\n"
    "interruption, byte for byte. Raises InputError for another scene or model, a damaged file, and a run to which\n"
    "something was added: run its recording again.";

}  // namespace

RunModels models_of(const geo::Scene& scene, const Meshes& given) {
  if (!given.empty() && given.size() != scene.bodies.size())
    throw geo::InputError("models: " + std::to_string(given.size()) + " given for " +
                          std::to_string(scene.bodies.size()) + " bodies; give one for each");
  RunModels out;
  std::vector<geo::TriangleMesh> meshes;
  std::string hashes = std::to_string(scene.fingerprint);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto& path = scene.bodies[i].mesh;
    const auto bytes = given.empty() ? geo::read_all(path) : bytes_of(given[i]->mesh);
    meshes.push_back(given.empty() ? geo::parse_surface(bytes, path).mesh : given[i]->mesh);
    require_whole(meshes.back(), given.empty() ? path : "models");
    meshes.back().attributes.library = {};                // each frame would hold its images
    meshes.back().unit = meshes.back().unit > 0 ? 1 : 0;  // scenes are in metres
    hashes += " " + std::to_string(geo::fingerprint(bytes));
  }
  out.fingerprint = geo::fingerprint(hashes);
  out.placed = geo::place_models(scene, std::move(meshes));
  if (out.placed.bodies.size() > 1) out.placed.all.attributes = geo::joined_attributes(out.placed.bodies);
  return out;
}

Simulation::Simulation(std::shared_ptr<const Scene> source, RunModels run_models, const geo::Progress& progress)
    : scene(std::move(source)), models(std::move(run_models)) {
  std::ostringstream out;
  {
    const auto fresh = geo::begin_run(scene->scene, models.placed, progress);
    geo::write_checkpoint(out, fresh.body, fresh.state, models.fingerprint);
  }
  auto c = geo::read_checkpoint(geo::KerfFile(geo::Input(std::move(out).str(), "checkpoint")));
  run_.emplace(scene->scene, std::move(c.body), std::move(c.state));
}

Simulation::Simulation(std::shared_ptr<const Scene> source, RunModels run_models, const geo::Scene& moved_scene,
                       const std::string& checkpoint)
    : scene(std::move(source)),
      models(std::move(run_models)),
      unrecordable("the run was resumed, and its earlier checkpoints are not known; record a run from its begin") {
  auto c = geo::read_checkpoint(geo::KerfFile(geo::Input(checkpoint, "checkpoint")));
  if (c.scene != models.fingerprint)
    throw geo::InputError("the checkpoint was begun with another scene, model or setting; give the same ones");
  run_.emplace(moved_scene, std::move(c.body), std::move(c.state));
}

geo::Simulation& Simulation::run() {
  if (!failure_.empty()) throw geo::GeometryError(failure_);
  return *run_;
}

geo::FrameStats Simulation::advance(const geo::Progress& progress) {
  bool stopped = false;
  geo::FrameStats stats;
  run();
  try {
    stats = run_->advance_frame([&](std::string_view phase, std::size_t done, std::size_t total) {
      stopped = stopped || !progress(phase, done, total);
      return true;
    });
    if (scene->scene.has_checkpoint(run_->state().frame)) go_on_from_checkpoint(models.fingerprint);
  } catch (const std::exception& e) {
    failure_ = e.what();
    throw;
  }
  if (stopped) throw geo::Interrupted();
  return stats;
}

geo::Scene Simulation::recording() {
  if (!unrecordable.empty()) throw geo::InputError(unrecordable);
  geo::Scene all = geo::recording_of(scene->scene, run());
  const auto make_absolute = [&](std::string& path) {
    if (!path.empty()) path = (scene->place / path).string();
  };
  for (auto& body : all.bodies) make_absolute(body.mesh);
  for (auto& obstacle : all.obstacles) make_absolute(obstacle.file);
  for (geo::SceneScoreFile& score : all.score_files) make_absolute(score.file);
  std::vector<int> frames;
  std::set_union(all.checkpoints.begin(), all.checkpoints.end(), checkpoints_.begin(), checkpoints_.end(),
                 std::back_inserter(frames));
  all.checkpoints = std::move(frames);
  return all;
}

std::string Simulation::checkpoint() {
  const int frame = run().state().frame;
  if (frame > 0 && (checkpoints_.empty() || checkpoints_.back() != frame)) checkpoints_.push_back(frame);
  // A run to which something was added is not that of its scene: resume() refuses its checkpoints.
  return go_on_from_checkpoint(acted ? geo::fingerprint(std::to_string(models.fingerprint) + " and more")
                                     : models.fingerprint);
}

std::string Simulation::go_on_from_checkpoint(std::uint64_t fingerprint) {
  std::ostringstream out;
  geo::write_checkpoint(out, run().body(), run().state(), fingerprint);
  auto bytes = std::move(out).str();
  auto c = geo::read_checkpoint(geo::KerfFile(geo::Input(bytes, "checkpoint")));
  run_->restore(std::move(c.body), std::move(c.state));
  return bytes;
}

void Simulation::changed() { positions = displacement = velocities = stress = surface = body = state = py::object(); }

void bind_simulation(py::module_& module) {
  Class simulation(module, "Simulation", simulation_doc);
  simulation.def(py::init(&begun), py::arg("scene"), py::kw_only(), py::arg("models") = py::none(),
                 py::arg("set") = py::none(), py::arg("progress") = py::none(), "See the class.");
  simulation
      .def(
          "step",
          [](Simulation& self, py::object progress) {
            ProgressReport report(std::move(progress));
            return frame(self, report, 0, 1);
          },
          py::kw_only(), py::arg("progress") = py::none(),
          "Makes the time steps up to the next frame; returns FrameStats. A stop by progress or Ctrl-C takes effect "
          "at\n"
          "the end of the frame. Raises GeometryError where a position is no longer finite.")
      .def("run", &run_frames, py::arg("frames") = py::none(), py::kw_only(), py::arg("progress") = py::none(),
           py::arg("each") = py::none(), run_doc)
      .def_property_readonly(
          "touching", [](const Simulation& self) { return geo::touching_note(self.scene->scene, self.models.placed); },
          "A line that names the bodies that touched when they were placed, and the gap that was made between them; "
          "''\n"
          "where none did.")
      .def("save", &save, py::arg("path"),
           "Writes a checkpoint (.kerf), from which resume() continues exactly; with motions, where objects were moved "
           "by\n"
           "hand. It does not hold what was added or changed: resume() then refuses it. Raises OutputError.")
      .def_static("resume", &resumed, py::arg("path"), py::arg("scene"), py::kw_only(), py::arg("models") = py::none(),
                  py::arg("set") = py::none(), py::arg("motions") = py::none(), resume_doc);
  add_views(simulation);
  add_handles(module, simulation);
  add_hands(module, simulation);
}

}  // namespace kerf_python
