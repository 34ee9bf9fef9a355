// Simulations of kerf.h: scenes, frames, what moves in them, and what is read from them.
#include "kerf/simulation.h"

#include <cmath>
#include <limits>

#include "call.h"
#include "kerf/files.h"
#include "kerf/jobs.h"
#include "objects.h"

namespace kerf_c {
namespace {

struct SimulationObject : Object {
  static constexpr Kind kind = Kind::simulation;
  SimulationObject(geo::Simulation of, geo::TriangleMesh model)
      : Object(kind), run(std::move(of)), models(std::move(model)) {}
  geo::Simulation run;
  geo::TriangleMesh models;
  geo::FrameStats last;  // of the last frame
  bool stopped = false;  // in the middle of a frame
};
using Run = Writing<SimulationObject>;
using View = Reading<SimulationObject>;

// Throws InputError for a run that cannot go on.
void require_whole(const SimulationObject& simulation) {
  if (simulation.stopped)
    throw geo::InputError("the simulation was stopped, or failed, in the middle of a frame; make another one");
}

std::shared_ptr<Object> simulation_for(geo::Scene scene, std::vector<geo::TriangleMesh> models,
                                       const geo::Progress& progress) {
  if (scene.bodies.empty()) throw geo::InputError("the scene has no body; add [[body]]");
  geo::PlacedModels placed = geo::place_models(scene, std::move(models));
  geo::Simulation run(scene, placed, progress);
  return std::make_shared<SimulationObject>(std::move(run), std::move(placed.all));
}

geo::Pose pose_of(const kerf_pose* pose) {
  const kerf_pose& from = required(pose, "pose");
  geo::Pose to;
  to.position = point_of(from.position, "pose.position");
  const Eigen::Vector4d q(from.rotation[0], from.rotation[1], from.rotation[2], from.rotation[3]);
  const double length = q.stableNorm();
  if (!(length > 0 && length <= 1e30)) throw ArgumentError("pose.rotation: give w, x, y, z, not all 0");
  to.rotation = Eigen::Quaterniond(q[0] / length, q[1] / length, q[2] / length, q[3] / length);
  return to;
}

template <class Objects>
std::uint32_t checked(std::uint32_t index, const Objects& all, const char* what) {
  if (index >= all.size())
    throw ArgumentError("index: there is no " + std::string(what) + " " + std::to_string(index) + "; there are " +
                        std::to_string(all.size()) + ", from 0 on");
  return index;
}

std::span<const double> numbers_of(const std::vector<geo::Vec3>& points) {
  return points.empty() ? std::span<const double>() : std::span(points[0].data(), 3 * points.size());
}

kerf_frame frame_of(const SimulationObject& simulation) {
  const geo::FrameStats& from = simulation.last;
  kerf_frame to{};
  to.time = simulation.run.state().time;
  to.frame = simulation.run.state().frame;
  to.elastic = from.energy;
  to.kinetic = from.kinetic;
  to.cut_edges = from.split.edges_cut;
  to.refused = from.refused;
  to.new_cracks = from.fracture.begun;
  to.seconds = from.phase_seconds();
  return to;
}

// The force on an object in the last frame; zero before the first frame that had it.
void give_force(const std::vector<geo::Vec3>& forces, std::uint32_t index, double* force) {
  required(force, "force");
  const geo::Vec3 value = index < forces.size() ? forces[index] : geo::Vec3::Zero();
  for (int i = 0; i < 3; ++i) force[i] = value[i];
}

}  // namespace
}  // namespace kerf_c

using namespace kerf_c;

kerf_status kerf_simulation_create(const char* scene, size_t scene_length, const char* folder, const kerf_mesh* models,
                                   size_t model_count, kerf_progress progress, void* user,
                                   kerf_simulation* simulation) {
  return call([&] {
    NewHandle out(simulation, "simulation");
    const auto text = array_of(scene, scene_length, 1, "scene");
    const auto handles = array_of(models, model_count, 1, "models");
    const std::string place = folder ? folder : "";
    const geo::Scene parsed = geo::parse_scene(std::string(text.begin(), text.end()), "scene", {}, place);
    std::vector<geo::TriangleMesh> meshes;
    for (const kerf_mesh handle : handles) meshes.push_back(Reading<MeshObject>(handle)->mesh);
    if (handles.empty())
      for (const geo::SceneBody& body : parsed.bodies) meshes.push_back(geo::read_surface(body.mesh).mesh);
    out.set(simulation_for(parsed, std::move(meshes), progress_of(progress, user)));
  });
}

kerf_status kerf_simulation_load(const char* scene_path, kerf_progress progress, void* user,
                                 kerf_simulation* simulation) {
  return call([&] {
    NewHandle out(simulation, "simulation");
    const geo::Scene scene = geo::read_scene(path_of(scene_path, "scene_path"));
    std::vector<geo::TriangleMesh> meshes;
    for (const geo::SceneBody& body : scene.bodies) meshes.push_back(geo::read_surface(body.mesh).mesh);
    out.set(simulation_for(scene, std::move(meshes), progress_of(progress, user)));
  });
}

kerf_status kerf_simulation_step(kerf_simulation simulation, kerf_progress progress, void* user, kerf_frame* frame) {
  return call([&] {
    const Run use(simulation);
    require_whole(*use);
    use->stopped = true;
    use->last = use->run.advance_frame(progress_of(progress, user));
    use->stopped = false;
    if (frame) *frame = frame_of(*use);
  });
}

kerf_status kerf_simulation_frame(kerf_simulation simulation, kerf_frame* frame) {
  return call([&] {
    kerf_frame& to = required(frame, "frame");
    to = frame_of(*View(simulation));
  });
}

kerf_status kerf_simulation_positions(kerf_simulation simulation, double* points, size_t length, size_t* needed) {
  return call([&] {
    const View use(simulation);
    std::vector<geo::Vec3> positions = use->run.body().nodes.position;
    const auto& moved = use->run.state().motion.displacement;
    for (std::size_t i = 0; i < positions.size() && i < moved.size(); ++i) positions[i] += moved[i];
    copy_out(numbers_of(positions), points, length, needed);
  });
}

kerf_status kerf_simulation_velocities(kerf_simulation simulation, double* points, size_t length, size_t* needed) {
  return call([&] {
    const View use(simulation);
    copy_out(numbers_of(use->run.state().motion.velocity), points, length, needed);
  });
}

kerf_status kerf_simulation_stress(kerf_simulation simulation, double* values, size_t length, size_t* needed) {
  return call([&] {
    const Run use(simulation);  // solid() may update points
    require_whole(*use);
    copy_out(geo::von_mises_stress(use->run.solid(), use->run.body().nodes, use->run.state().motion), values, length,
             needed);
  });
}

kerf_status kerf_simulation_surface(kerf_simulation simulation, kerf_mesh* surface) {
  return call([&] {
    NewHandle out(surface, "surface");
    const Run use(simulation);
    require_whole(*use);
    out.set(object_for(use->run.surface(&use->models)));
  });
}

kerf_status kerf_blade_defaults(kerf_blade_options* options) {
  return call([&] {
    const geo::Blade from;
    kerf_blade_options to{};
    to.thickness = from.thickness;
    to.stiffness = from.stiffness;
    to.limit = from.limit;
    copy_point(from.back, to.back);
    required(options, "options") = to;
  });
}

kerf_status kerf_simulation_add_blade(kerf_simulation simulation, const kerf_blade_options* blade,
                                      const kerf_pose* pose, uint32_t* index) {
  return call([&] {
    std::uint32_t& out = required(index, "index");
    const kerf_blade_options& from = required(blade, "blade");
    const geo::Pose at = pose_of(pose);
    geo::Blade to;
    to.points = points_of(from.points, from.points_length, "blade.points");
    to.closed = flag_of(from.closed, "blade.closed");
    to.back = point_of(from.back, "blade.back");
    to.thickness = number_of(from.thickness, 0, 1e9, "blade.thickness");
    to.stiffness = number_of(from.stiffness, 0, 1e12, "blade.stiffness");
    to.limit = number_of(from.limit, 1e-3, 1e9, "blade.limit");
    if (to.thickness > 0 && !(to.back.norm() > 0))
      throw geo::InputError("blade.back: a blade with thickness needs the vector from its edge to its back");
    const Run use(simulation);
    require_whole(*use);
    to.name = "blade" + std::to_string(use->run.scene().blades.size() + 1);
    out = static_cast<std::uint32_t>(use->run.add_blade(std::move(to), at).index());
  });
}

kerf_status kerf_simulation_move_blade(kerf_simulation simulation, uint32_t index, const kerf_pose* pose) {
  return call([&] {
    const geo::Pose to = pose_of(pose);
    const Run use(simulation);
    require_whole(*use);
    use->run.blade(checked(index, use->run.scene().blades, "blade")).drive_to(to);
  });
}

kerf_status kerf_simulation_blade(kerf_simulation simulation, const char* name, uint32_t* index) {
  return call([&] {
    std::uint32_t& out = required(index, "index");
    const std::string wanted = text_of(name, "name");
    const View use(simulation);
    const auto& blades = use->run.scene().blades;
    for (std::size_t i = 0; i < blades.size(); ++i)
      if (blades[i].name == wanted) {
        out = static_cast<std::uint32_t>(i);
        return;
      }
    throw geo::InputError("the scene has no blade '" + wanted + "'");
  });
}

kerf_status kerf_simulation_blade_force(kerf_simulation simulation, uint32_t index, double force[3]) {
  return call([&] {
    const View use(simulation);
    give_force(use->last.blade_force, checked(index, use->run.scene().blades, "blade"), force);
  });
}

kerf_status kerf_simulation_add_grip(kerf_simulation simulation, const double low[3], const double high[3],
                                     uint32_t* index) {
  return call([&] {
    std::uint32_t& out = required(index, "index");
    const geo::Grip grip{.lo = point_of(low, "low"), .hi = point_of(high, "high")};
    if (!(grip.lo.array() <= grip.hi.array()).all()) throw ArgumentError("low: a coordinate is above that of high");
    const Run use(simulation);
    require_whole(*use);
    out = static_cast<std::uint32_t>(use->run.add_grip(grip).index());
  });
}

kerf_status kerf_simulation_move_grip(kerf_simulation simulation, uint32_t index, const kerf_pose* pose) {
  return call([&] {
    const geo::Pose to = pose_of(pose);
    const Run use(simulation);
    require_whole(*use);
    use->run.grip(checked(index, use->run.scene().grips, "grip")).drive_to(to);
  });
}

kerf_status kerf_simulation_end_grip(kerf_simulation simulation, uint32_t index) {
  return call([&] {
    const Run use(simulation);
    require_whole(*use);
    use->run.grip(checked(index, use->run.scene().grips, "grip")).end();
  });
}

kerf_status kerf_simulation_add_pull(kerf_simulation simulation, const double point[3], const double end[3],
                                     double stiffness, uint32_t* index) {
  return call([&] {
    std::uint32_t& out = required(index, "index");
    geo::Pull pull;
    pull.point = point_of(point, "point");
    pull.stiffness = number_of(stiffness, 0, 1e15, "stiffness");
    const geo::Vec3 to = point_of(end, "end");
    const Run use(simulation);
    require_whole(*use);
    out = static_cast<std::uint32_t>(use->run.add_pull(std::move(pull), to).index());
  });
}

kerf_status kerf_simulation_move_pull(kerf_simulation simulation, uint32_t index, const double end[3]) {
  return call([&] {
    const geo::Vec3 to = point_of(end, "end");
    const Run use(simulation);
    require_whole(*use);
    use->run.pull(checked(index, use->run.scene().pulls, "pull")).drive_to(to);
  });
}

kerf_status kerf_simulation_pull_force(kerf_simulation simulation, uint32_t index, double force[3]) {
  return call([&] {
    const View use(simulation);
    give_force(use->last.pull_force, checked(index, use->run.scene().pulls, "pull"), force);
  });
}

kerf_status kerf_simulation_move_obstacle(kerf_simulation simulation, uint32_t index, const kerf_pose* pose) {
  return call([&] {
    const geo::Pose to = pose_of(pose);
    const Run use(simulation);
    require_whole(*use);
    use->run.obstacle(checked(index, use->run.scene().obstacles, "obstacle")).drive_to(to);
  });
}

kerf_status kerf_simulation_strike(kerf_simulation simulation, const double point[3], int32_t cells) {
  return call([&] {
    constexpr std::int32_t least_cells = 2, max_cells = 1000;  // as in scenes
    const geo::Vec3 at = point_of(point, "point");
    if (cells < least_cells || cells > max_cells) throw ArgumentError("cells: give a number from 2 to 1000");
    const Run use(simulation);
    require_whole(*use);
    use->run.strike({.point = at, .cells = cells});
  });
}

kerf_status kerf_simulation_change(kerf_simulation simulation, const kerf_changes* changes) {
  return call([&] {
    const kerf_changes& from = required(changes, "changes");
    geo::SceneChange change;
    const auto take = [](double value, std::optional<double>& to) {
      if (value >= 0) to = number_of(value, 0, 1e30, "a value of changes");
    };
    take(from.young, change.young);
    take(from.damping, change.damping);
    take(from.friction, change.friction);
    take(from.step, change.dt);
    if (flag_of(from.has_gravity, "has_gravity")) change.gravity = point_of(from.gravity, "gravity");
    const Run use(simulation);
    require_whole(*use);
    use->run.change(change);
  });
}
