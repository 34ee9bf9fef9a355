// Simulation of kerf/simulation.h: what callers change between two frames, and the deformed surface.
// The time loop computes the frames.
#include "kerf/simulation.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/deformation.h"
#include "simulation/run_data.h"
#include "simulation/time_loop.h"

namespace geo {
namespace {

// A key with this rotation, whose axis is arbitrary where there is none.
Motion::Key key_at(double time, const Pose& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  return {time, pose.position, turn.angle() == 0 ? Vec3(Vec3::UnitZ()) : turn.axis(),
          turn.angle() * 180 / std::numbers::pi};
}

// From the present pose at time `from` to `pose` at time `to`.
Motion towards(const Motion& present, double from, double to, const Pose& pose) {
  return {{key_at(from, present.at(from)), key_at(to, pose)}};
}

void append(Motion& motion, const Motion::Key& key) {
  if (!motion.keys.empty() && !(motion.keys.back().time < key.time))
    throw InputError("a motion has a key at this time, or later");
  motion.keys.push_back(key);
}

}  // namespace

struct Simulation::Impl {
  Impl(const Scene& scene, Body body, RunState state)
      : run(scene, std::move(body), std::move(state)), loop(std::make_unique<TimeLoop>(run)) {}
  double time_of(int frame) const { return frame * (1 / run.scene.frame_rate); }

  RunData run;
  std::unique_ptr<TimeLoop> loop;
};

Simulation::Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress)
    : Simulation(scene, PlacedModels{solid, {solid}}, progress) {}

Simulation::Simulation(const Scene& scene, const PlacedModels& models, const Progress& progress) {
  RunStart run = begin_run(scene, models, progress);
  impl_ = std::make_unique<Impl>(scene, std::move(run.body), std::move(run.state));
}

Simulation::Simulation(const Scene& scene, Body body, RunState state)
    : impl_(std::make_unique<Impl>(scene, std::move(body), std::move(state))) {}

Simulation::Simulation(Simulation&& other) noexcept = default;
Simulation& Simulation::operator=(Simulation&& other) noexcept = default;
Simulation::~Simulation() = default;

const Body& Simulation::body() const { return impl_->run.body; }
const RunState& Simulation::state() const { return impl_->run.state; }
const Solid& Simulation::solid() const { return impl_->run.solid.whole(); }
const Scene& Simulation::scene() const { return impl_->run.scene; }

void Simulation::restore(Body body, RunState state) {
  impl_->run.restore(std::move(body), std::move(state));
  impl_->loop = std::make_unique<TimeLoop>(impl_->run);
}

void Simulation::move_blade(std::size_t blade, const Pose& pose) {
  Motion& motion = impl_->run.scene.blades.at(blade).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

void Simulation::move_grip(std::size_t grip, const Pose& pose) {
  Motion& motion = impl_->run.scene.grips.at(grip).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

void Simulation::move_obstacle(std::size_t obstacle, const Pose& pose) {
  Motion& motion = impl_->run.scene.obstacles.at(obstacle).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

std::size_t Simulation::add_blade(Blade blade) {
  if (blade.points.size() < (blade.closed ? 3 : 2))
    throw InputError("a blade has two points at least, three if closed");
  impl_->run.scene.blades.push_back(std::move(blade));
  impl_->run.state.fronts.emplace_back();
  return impl_->run.scene.blades.size() - 1;
}

std::size_t Simulation::add_grip(Grip grip) {
  grip.from = std::max(grip.from, impl_->time_of(state().frame));
  impl_->run.scene.grips.push_back(std::move(grip));
  impl_->loop->follow_grips();
  return impl_->run.scene.grips.size() - 1;
}

std::size_t Simulation::add_pull(Pull pull) {
  if (pull.node && *pull.node >= body().nodes.size()) throw InputError("a pull holds a node that does not exist");
  impl_->run.scene.pulls.push_back(std::move(pull));
  return impl_->run.scene.pulls.size() - 1;
}

void Simulation::extend_blade(std::size_t blade, int frame, const Pose& pose) {
  append(impl_->run.scene.blades.at(blade).motion, key_at(impl_->time_of(state().frame + frame), pose));
}

// A pull that rests has two keys, however long it does: interpolation between equal positions is
// exact.
void Simulation::extend_pull(std::size_t pull, int frame, const Vec3& position) {
  Motion& motion = impl_->run.scene.pulls.at(pull).motion;
  append(motion, {impl_->time_of(state().frame + frame), position, Vec3::UnitZ(), 0});
  auto& keys = motion.keys;
  const auto n = keys.size();
  if (n < 3 || keys[n - 2].position != position || keys[n - 3].position != position) return;
  keys[n - 2].time = keys[n - 1].time;
  keys.pop_back();
}

void Simulation::end_grip(std::size_t grip) {
  double& until = impl_->run.scene.grips.at(grip).until;
  until = std::min(until, impl_->time_of(state().frame));
}

void Simulation::change(SceneChange change) {
  change.time = impl_->time_of(state().frame);
  if (const auto wrong = unfit(change); !wrong.empty()) throw InputError(wrong);
  impl_->run.scene.add_change(change);
}

FrameStats Simulation::advance_frame(const Progress& progress) { return impl_->loop->advance_frame(progress); }

TriangleMesh Simulation::surface(const TriangleMesh* model) const {
  const RunData& run = impl_->run;
  const Collisions& collisions = impl_->loop->collisions();
  std::vector<std::uint32_t> rows;  // per surface vertex: its index in the mesh, ~0u for none
  TriangleMesh mesh = run.body.surface.two_sided(&rows);
  if (model) transfer_attributes(*model, mesh);
  mesh.attributes.normal.clear();
  if (collisions.on()) {
    mesh.vertices = collisions.living_positions(run.body);
    return mesh;
  }
  const std::vector<Vec3>& u = run.state.motion.displacement;
  const auto gradient = run.solid.nodes().gradients(u);
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> nodes;
    for (std::size_t v = begin; v < end; ++v) {
      if (rows[v] == ~0u) continue;
      carrier_nodes(run.body, SurfaceVertexId(v), nodes);
      Vec3& x = mesh.vertices[rows[v]];
      if (!nodes.empty()) x += displacement_at(x, nodes, run.body.nodes, u, gradient);
    }
  });
  return mesh;
}

}  // namespace geo
