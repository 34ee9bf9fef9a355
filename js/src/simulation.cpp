// Runs of scenes: frames, fields of the nodes, blades, grips and springs that a program moves.
#include <malloc.h>

#include <sstream>

#include <kerf/body_file.h>
#include <kerf/check.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include <kerf/simulation.h>
#include "bind.h"

namespace kerf_js {
namespace {

// A run, with the models that it was made of.
struct Run : geo::Simulation {
  Run(const geo::Scene& scene, const geo::PlacedModels& placed, const geo::Progress& progress)
      : geo::Simulation(scene, placed, progress), models(placed.all) {}
  geo::TriangleMesh models;
};
using RunHandle = std::shared_ptr<Run>;

// A model of a scene as the tools treat it: valid, whole, in metres.
geo::TriangleMesh scene_model(const val& given, const std::string& name) {
  geo::TriangleMesh mesh;
  mesh.vertices = points_from(given["vertices"], name);
  const auto corners = numbers_from<std::uint32_t>(given["faces"]);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  read_attributes(given, mesh);
  try {
    demand_solid(mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(name + ": " + e.what());
  }
  return mesh;
}

// scene: TOML; models: a list of {vertices, faces} with attributes; overrides: a list of [key, value as TOML].
val begin_run(const std::string& scene_text, const val& models, const val& overrides, const val& progress) {
  return guarded([&] {
    geo::SceneOverrides values;
    for (unsigned i = 0; i < overrides["length"].as<unsigned>(); ++i)
      values.emplace_back(overrides[i][0].as<std::string>(), overrides[i][1].as<std::string>());
    const geo::Scene scene = geo::parse_scene(scene_text, "scene", values);
    std::vector<geo::TriangleMesh> meshes;
    for (unsigned i = 0; i < models["length"].as<unsigned>(); ++i)
      meshes.push_back(scene_model(models[i], "model " + std::to_string(i)));
    return std::make_shared<Run>(scene, geo::place_models(scene, std::move(meshes)), progress_to(progress));
  });
}

val step(const RunHandle& run, const val& progress) {
  return guarded([&] {
    const geo::FrameStats stats = run->advance_frame(progress_to(progress));
    val result = val::object();
    result.set("elastic", stats.energy);
    result.set("kinetic", stats.kinetic);
    result.set("refused", double(stats.refused));
    result.set("newton", double(stats.newton));
    result.set("edgesCut", double(stats.split.edges_cut));
    result.set("bladeForce", array_of(stats.blade_force));
    result.set("pullForce", array_of(stats.pull_force));
    result.set("obstacleForce", array_of(stats.obstacle_force));
    return result;
  });
}

// A field of the run by its name.
val field(const RunHandle& run, const std::string& name) {
  return guarded([&]() -> val {
    const geo::State& motion = run->state().motion;
    const geo::NodeSet& nodes = run->body().nodes;
    if (name == "time") return val(run->state().time);
    if (name == "frame") return val(run->state().frame);
    if (name == "frames") return val(run->scene().frames);
    if (name == "velocities") return array_of(motion.velocity);
    if (name == "stress") return array_of(geo::von_mises_stress(run->solid(), nodes, motion));
    if (name == "pieces") return val(geo::find_pieces(run->body().surface).count);
    std::vector<geo::Vec3> at = nodes.position;
    if (name == "positions")
      for (std::size_t i = 0; i < at.size(); ++i) at[i] += motion.displacement[i];
    return array_of(at);
  });
}

// The deformed surface as arrays; attributes are those of the model, where there is one body.
val surface(const RunHandle& run) {
  return guarded([&] {
    const geo::TriangleMesh mesh = run->surface(&run->models);
    val result = val::object();
    for (const char* name : {"uv", "colors", "groups", "groupNames"})
      result.set(name, attribute_array(mesh.attributes, name));
    result.set("vertices", array_of(mesh.vertices));
    result.set("faces", array_of(mesh.triangles.data()->data(), 3 * mesh.triangles.size()));
    result.set("patch", array_of(mesh.patch));
    result.set("site", array_of(mesh.site));
    return result;
  });
}

val save_run(const RunHandle& run, const std::string& format) {
  return guarded([&] {
    std::ostringstream out;
    if (format == "kerf")
      geo::write_body(out, run->body());
    else if (format == "ply")
      geo::write_ply(out, run->surface());
    else
      throw geo::InputError("save: '" + format + "' is none of kerf, ply");
    return bytes_of(std::move(out).str());
  });
}

// ---- What a program moves

// Position and quaternion (w, x, y, z).
geo::Pose pose_from(const val& given) {
  const auto values = numbers_from<double>(given);
  if (values.size() != 3 && values.size() != 7)
    throw geo::InputError("pose: give a position, or a position and a quaternion w, x, y, z");
  geo::Pose pose;
  pose.position = {values[0], values[1], values[2]};
  if (!pose.position.allFinite()) throw geo::InputError("pose: a coordinate is no finite number");
  if (values.size() == 3) return pose;
  pose.rotation = Eigen::Quaterniond(values[3], values[4], values[5], values[6]);
  if (!(pose.rotation.norm() > 1e-9)) throw geo::InputError("pose: the quaternion has no direction");
  pose.rotation.normalize();
  return pose;
}

std::size_t index_of(int index, std::size_t count, const char* kind) {
  if (index < 0 || static_cast<std::size_t>(index) >= count)
    throw geo::InputError(std::string(kind) + " " + std::to_string(index) + ": the run has " + std::to_string(count));
  return static_cast<std::size_t>(index);
}

val add_blade(const RunHandle& run, const val& points, const val& pose, const val& options) {
  return guarded([&] {
    geo::Blade blade;
    blade.points = points_from(points, "points");
    take(options, "thickness", blade.thickness, 0, 1e9);
    take(options, "stiffness", blade.stiffness, 0, 1e12);
    if (has(options, "closed")) blade.closed = options["closed"].as<bool>();
    if (has(options, "back")) blade.back = point_from(options["back"], "back");
    if (blade.thickness > 0 && !(blade.back.norm() > 0))
      throw geo::InputError("back: a blade with thickness needs the vector from its edge to its back");
    blade.name = "blade" + std::to_string(run->scene().blades.size() + 1);
    return double(run->add_blade(std::move(blade), pose_from(pose)).index());
  });
}

val move(const RunHandle& run, const std::string& kind, int index, const val& pose) {
  return guarded([&] {
    const geo::Scene& scene = run->scene();
    if (kind == "blade")
      run->blade(index_of(index, scene.blades.size(), "blade")).drive_to(pose_from(pose));
    else if (kind == "grip")
      run->grip(index_of(index, scene.grips.size(), "grip")).drive_to(pose_from(pose));
    else if (kind == "obstacle")
      run->obstacle(index_of(index, scene.obstacles.size(), "obstacle")).drive_to(pose_from(pose));
    else
      run->pull(index_of(index, scene.pulls.size(), "pull")).drive_to(point_from(pose, "to"));
  });
}

val add_grip(const RunHandle& run, const val& lo, const val& hi) {
  return guarded([&] {
    geo::Grip grip;
    grip.lo = point_from(lo, "lo");
    grip.hi = point_from(hi, "hi");
    if (!(grip.lo.array() <= grip.hi.array()).all()) throw geo::InputError("lo: a corner is above that of hi");
    return double(run->add_grip(std::move(grip)).index());
  });
}

val end_grip(const RunHandle& run, int index) {
  return guarded([&] { run->grip(index_of(index, run->scene().grips.size(), "grip")).end(); });
}

val add_pull(const RunHandle& run, const val& point, const val& to, double stiffness) {
  return guarded([&] {
    geo::Pull pull;
    pull.point = point_from(point, "point");
    pull.stiffness = stiffness;
    if (!(stiffness >= 0 && stiffness <= 1e15)) throw geo::InputError("stiffness: give a number from 0 to 1e15");
    return double(run->add_pull(std::move(pull), point_from(to, "to")).index());
  });
}

val strike(const RunHandle& run, const val& point, const val& options) {
  return guarded([&] {
    geo::Blow blow{.point = point_from(point, "point")};
    take(options, "cells", blow.cells, 2, 1000);
    run->strike(blow);
  });
}

val change(const RunHandle& run, const val& values) {
  return guarded([&] {
    geo::SceneChange changes;
    const auto take_value = [&](const char* name, std::optional<double>& out) {
      double value = 0;
      take(values, name, value, -1e300, 1e300);
      if (has(values, name)) out = value;
    };
    take_value("young", changes.young);
    take_value("damping", changes.damping);
    take_value("friction", changes.friction);
    take_value("accuracy", changes.accuracy);
    take_value("step", changes.dt);
    if (has(values, "gravity")) changes.gravity = point_from(values["gravity"], "gravity");
    run->change(changes);
  });
}

double used_bytes() { return double(mallinfo().uordblks); }

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_simulation) {
  emscripten::class_<Run>("RunHandle").smart_ptr<RunHandle>("RunHandle");
  emscripten::function("beginRun", &begin_run);
  emscripten::function("step", &step);
  emscripten::function("field", &field);
  emscripten::function("surface", &surface);
  emscripten::function("saveRun", &save_run);
  emscripten::function("addBlade", &add_blade);
  emscripten::function("move", &move);
  emscripten::function("addGrip", &add_grip);
  emscripten::function("endGrip", &end_grip);
  emscripten::function("addPull", &add_pull);
  emscripten::function("strike", &strike);
  emscripten::function("change", &change);
  emscripten::function("usedBytes", &used_bytes);
}

}  // namespace kerf_js
