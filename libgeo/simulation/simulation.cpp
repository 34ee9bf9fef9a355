// Simulation of kerf/simulation.h: what callers change between two frames, and the deformed
// surface. The time loop computes the frames.
#include "kerf/simulation.h"

#include <algorithm>
#include <utility>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/blow.h"
#include "simulation/driven_motion.h"
#include "simulation/run_data.h"
#include "simulation/stitches.h"
#include "simulation/time_loop.h"

namespace geo {

struct Simulation::Impl {
  Impl(const Scene& scene, Body body, RunState state)
      : run(scene, std::move(body), std::move(state)),
        loop(std::make_unique<TimeLoop>(run)),
        given_blows(scene.blows.size()) {}
  // Time of a frame, in seconds. `frame`: 0 is the present one, 1 the next.
  double time_of(int frame) const { return (run.state.frame + frame) * (1 / run.scene.frame_rate); }
  Motion& motion_of(Handle::Kind kind, std::size_t index) {
    switch (kind) {
      case Handle::Kind::blade:
        return run.scene.blades.at(index).motion;
      case Handle::Kind::grip:
        return run.scene.grips.at(index).motion;
      case Handle::Kind::obstacle:
        break;
    }
    return run.scene.obstacles.at(index).motion;
  }

  RunData run;
  std::unique_ptr<TimeLoop> loop;
  std::size_t given_blows;                // of the scene that the run began with; later ones have fallen already
  std::size_t blows = 0, blow_parts = 0;  // since the last frame

  void strike(RunStart broken) {
    const std::uint32_t before = find_pieces(run.body.surface).count;
    run.become(std::move(broken));
    ++blows;
    blow_parts += find_pieces(run.body.surface).count - before + 1;
    loop = std::make_unique<TimeLoop>(run);
  }
};

Simulation::Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress)
    : Simulation(scene, PlacedModels{.all = solid, .bodies = {solid}}, progress) {}

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
  impl_->blows = impl_->blow_parts = 0;
  impl_->loop = std::make_unique<TimeLoop>(impl_->run);
}

Simulation::Handle::Handle(Impl& run, Kind kind, std::size_t index) : run_(&run), kind_(kind), index_(index) {
  run.motion_of(kind, index);
}

const Motion& Simulation::Handle::motion() const { return run_->motion_of(kind_, index_); }

Pose Simulation::Handle::pose() const { return motion().at(run_->run.state.time); }

void Simulation::Handle::drive_to(const Pose& pose) {
  drive(run_->motion_of(kind_, index_), run_->time_of(0), key_at(run_->time_of(1), pose),
        kind_ == Kind::blade ? AfterLastKey::removed : AfterLastKey::stays);
}

void Simulation::GripHandle::end() {
  double& until = run().run.scene.grips.at(index()).until;
  until = std::min(until, run().time_of(0));
}

Simulation::PullHandle::PullHandle(Impl& run, std::size_t index) : run_(&run), index_(index) {
  run.run.scene.pulls.at(index);
}

Vec3 Simulation::PullHandle::end() const {
  return run_->run.scene.pulls.at(index_).motion.at(run_->run.state.time).position;
}

// A pull that rests has two keys, however long it does: interpolation between equal positions is
// exact.
void Simulation::PullHandle::drive_to(const Vec3& position) {
  Motion& motion = run_->run.scene.pulls.at(index_).motion;
  drive(motion, run_->time_of(0), {.time = run_->time_of(1), .position = position}, AfterLastKey::removed);
  auto& keys = motion.keys;
  const auto n = keys.size();
  if (n < 3 || keys[n - 2].position != position || keys[n - 3].position != position) return;
  keys[n - 2].time = keys[n - 1].time;
  keys.pop_back();
}

Simulation::StitchHandle::StitchHandle(Impl& run, std::size_t index) : run_(&run), index_(index) {
  run.run.scene.stitches.at(index);
}

void Simulation::StitchHandle::end() {
  double& until = run_->run.scene.stitches.at(index_).until;
  until = std::min(until, run_->time_of(0));
}

Simulation::Handle Simulation::blade(std::size_t index) { return {*impl_, Handle::Kind::blade, index}; }
Simulation::Handle Simulation::obstacle(std::size_t index) { return {*impl_, Handle::Kind::obstacle, index}; }
Simulation::GripHandle Simulation::grip(std::size_t index) { return {*impl_, index}; }
Simulation::PullHandle Simulation::pull(std::size_t index) { return {*impl_, index}; }
Simulation::StitchHandle Simulation::stitch(std::size_t index) { return {*impl_, index}; }

Simulation::Handle Simulation::add_blade(Blade blade) {
  if (blade.points.size() < (blade.closed ? 3 : 2))
    throw InputError("a blade has two points at least, three if closed");
  impl_->run.scene.blades.push_back(std::move(blade));
  impl_->run.state.fronts.emplace_back();
  return this->blade(scene().blades.size() - 1);
}

Simulation::Handle Simulation::add_blade(Blade blade, const Pose& pose) {
  blade.motion.keys = {key_at(impl_->time_of(0), pose)};
  return add_blade(std::move(blade));
}

Simulation::GripHandle Simulation::add_grip(Grip grip) {
  grip.from = std::max(grip.from, impl_->time_of(0));
  impl_->run.scene.grips.push_back(std::move(grip));
  impl_->loop->follow_grips();
  return this->grip(scene().grips.size() - 1);
}

Simulation::PullHandle Simulation::add_pull(Pull pull) {
  if (pull.node && *pull.node >= body().nodes.size()) throw InputError("a pull holds a node that does not exist");
  impl_->run.scene.pulls.push_back(std::move(pull));
  return this->pull(scene().pulls.size() - 1);
}

Simulation::PullHandle Simulation::add_pull(Pull pull, const Vec3& end) {
  pull.motion.keys = {{.time = impl_->time_of(0), .position = end}};
  return add_pull(std::move(pull));
}

Simulation::StitchHandle Simulation::add_stitch(Stitch stitch) {
  const double now = distance_of_ends(stitch, body(), impl_->run.solid.nodes(), state().motion.displacement);
  if (!stitch.slack) stitch.slack = now;
  stitch.from = impl_->time_of(0);
  impl_->run.scene.stitches.push_back(stitch);
  return this->stitch(scene().stitches.size() - 1);
}

void Simulation::change(SceneChange change) {
  change.time = impl_->time_of(0);
  if (const auto wrong = unfit(change); !wrong.empty()) throw InputError(wrong);
  impl_->run.scene.add_change(change);
}

void Simulation::strike(Blow blow) {
  if (blow.cells < 2 || !in_range(blow.point)) throw InputError("a blow has 2 cells at least, and a finite point");
  impl_->strike(broken_by(*this, blow));
  blow.time = state().time;
  impl_->run.scene.blows.push_back(blow);
}

// Blows fall where a frame begins at their time, or later than that by less than a frame. So a run
// that goes on from a checkpoint needs no note of those that have fallen.
FrameStats Simulation::advance_frame(const Progress& progress) {
  constexpr double tolerance = 1e-6;  // of a frame: times of frames are rounded
  const double frame = 1 / scene().frame_rate, now = impl_->time_of(0) + tolerance * frame;
  for (std::size_t b = 0; b < impl_->given_blows; ++b)
    if (const Blow& blow = scene().blows[b]; blow.time <= now && (state().frame == 0 || blow.time > now - frame))
      impl_->strike(broken_by(*this, blow));
  FrameStats stats = impl_->loop->advance_frame(progress);
  const std::size_t blows = std::exchange(impl_->blows, 0), parts = std::exchange(impl_->blow_parts, 0);
  for (FrameStats* to : {&stats, &impl_->run.state.total}) {
    to->blows += blows;
    to->blow_parts += parts;
  }
  return stats;
}

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
  const LazyNodalGradients gradient = lazy_gradients(SolidDiscretisation::of(run.solid.nodes()), u);
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
