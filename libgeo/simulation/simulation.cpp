#include "kerf/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "mechanics/discretisation/deformation.h"
#include "simulation/edge_runs.h"

namespace geo {

namespace {

// A state to go on from, with a part for each node.
RunState fitting(const Scene& scene, const Body& body, RunState state) {
  const std::size_t n = body.nodes.size();
  if (state.part.empty()) state.part.assign(n, 0);
  const bool known = std::all_of(state.part.begin(), state.part.end(), [&](auto p) { return p < scene.bodies.size(); });
  if (state.motion.displacement.size() != n || state.motion.velocity.size() != n || state.part.size() != n || !known ||
      state.fronts.size() != scene.blades.size())
    throw InputError("the checkpoint does not belong to this scene");
  return state;
}

}  // namespace

Simulation::Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress)
    : Simulation(scene, Model{solid, {solid}}, progress) {}

Simulation::Simulation(const Scene& scene, const Model& model, const Progress& progress)
    : Simulation(scene, begin_run(scene, model, progress)) {}

Simulation::Simulation(const Scene& scene, Beginning begun)
    : Simulation(scene, std::move(begun.body), std::move(begun.state)) {}

Simulation::Simulation(const Scene& scene, Body body, RunState state)
    : scene_(scene),
      state_(fitting(scene, body, std::move(state))),
      body_(std::move(body)),
      solid_(body_, materials_of(scene, state_.part)),
      obstacles_(scene) {
  begin();
}

void Simulation::take_up(Body body, RunState state) {
  state_ = fitting(scene_, body, std::move(state)), body_ = std::move(body);
  if (std::exchange(cut_, false)) solid_ = Solid(body_, materials_of(scene_, state_.part));
  obstacles_ = Obstacles(scene_), environment_ = {}, wedge_ = {};
  begin();
}

// With body, state and solid as they are.
void Simulation::begin() {
  if (solid_.size() != body_.nodes.size()) throw InputError("the checkpoint does not belong to this scene");
  prepare();
  collisions_.emplace(scene_, body_, solid_, state_.surface);
}

// What acts on nodes, as they are now.
void Simulation::prepare() {
  const std::size_t n = body_.nodes.size();
  environment_.gravity = scene_.gravity;
  environment_.ground = scene_.ground;
  environment_.ground_point = scene_.ground_point;
  environment_.ground_normal = scene_.ground_normal.normalized();
  environment_.ground_stiffness = scene_.ground_stiffness;
  environment_.friction = scene_.friction;
  environment_.fixed.assign(n, 0);
  environment_.clearance.assign(n, 0);
  gripped_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& x = body_.nodes.position[i];
    for (std::size_t g = 0; g < scene_.grips.size(); ++g) {
      const Grip& grip = scene_.grips[g];
      if ((x.array() < grip.lo.array()).any() || (x.array() > grip.hi.array()).any()) continue;
      gripped_.push_back({NodeId(i), g});
      break;
    }
    if (const auto v = body_.binding.closest[i]; v.valid() && body_.surface.alive(v))
      environment_.clearance[i] = (body_.surface.point(body_.surface.site(v)) - x).norm();
  }
}

// What follows the body after a crack.
void Simulation::adopt(const BodyDelta& delta, FrameStats& work) {
  if (delta.crack.empty()) return;
  Stopwatch watch;
  cut_ = true;
  parallel_invoke([&] { prepare(); },
                  [&] {
                    solid_.follow(body_, delta, state_.motion);
                    if (scene_.fracture.on) solid_.settle(body_, state_.motion);
                  });
  for (const NodeId d : delta.donors) state_.part.push_back(std::uint32_t(state_.part[d.index()]));
  work.mechanics_seconds += watch.lap();
  if (collisions_) collisions_->follow(body_, solid_, delta);
  obstacles_.follow();
  work.contact_seconds += watch.lap();
}

bool Simulation::split_step(FrontState& front, const std::vector<Vec3>& next, FrameStats& work) {
  CrackOptions options;
  options.seed = scene_.seed;
  try {
    adopt(split(body_, front, next, options, &work.split,
                collisions_ ? collisions_->agreement(body_, solid_, state_.motion, work.contact_seconds) : Agreement()),
          work);
    return true;
  } catch (const GeometryError&) {
    ++work.refused;
    return false;
  }
}

// From where the blades are to where they will be at the end of the step, in parts where an edge goes far.
void Simulation::cut(double dt, FrameStats& work) {
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    const Blade& blade = scene_.blades[b];
    if (!blade.active(state_.time)) {
      state_.fronts[b].clear();
      continue;
    }
    if (state_.fronts[b].empty()) cut_at(b, state_.time, work);
    const std::vector<Vec3> from = blade.at(state_.time), to = blade.at(state_.time + dt);
    double most = 0;
    for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
    const double finest = *std::min_element(body_.nodes.spacing.begin(), body_.nodes.spacing.end());
    const int parts = static_cast<int>(std::clamp(std::ceil(most / (blade.limit * finest)), 1.0, 64.0));
    for (int k = 1; k <= parts; ++k) cut_at(b, state_.time + dt * k / parts, work);
  }
}

void Simulation::cut_at(std::size_t b, double time, FrameStats& work) {
  Stopwatch watch;
  const Blade& blade = scene_.blades[b];
  std::vector<EdgeFront>& fronts = state_.fronts[b];
  const Pose pose = blade.motion.at(time);
  Box3 about;
  for (const Vec3& p : blade.points) about.add(pose * p);
  const NodeGradients gradient = solid_.gradients_when_asked(state_.motion.displacement);
  const PointMap map(body_, state_.motion.displacement, gradient, about);
  std::vector<std::vector<EdgePoint>> runs;
  if (blade.closed) {
    runs.push_back(closed_run(map, body_, blade, pose));
    if (fronts.empty()) fronts.resize(1);
  } else {
    runs = edge_runs(map, body_, blade, pose);
    fronts = fronts_of(runs, fronts);
  }
  work.front_seconds += watch.lap();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (fronts[r].at.empty()) {
      fronts[r] = begin_edge(runs[r], next_crack(), blade.name, blade.closed);
      continue;
    }
    std::vector<Vec3> to;
    EdgeFront edge = refined(fronts[r], runs[r], to);
    ++work.fronts;
    if (!split_step(edge.front, to, work)) continue;
    collapse(edge, runs[r]);
    fronts[r] = std::move(edge);
  }
}

// A number that no crack has, nor any front that will leave one.
std::int32_t Simulation::next_crack() const {
  std::int32_t last = body_.surface.crack_count();
  for (const auto& fronts : state_.fronts)
    for (const EdgeFront& edge : fronts) last = std::max(last, edge.front.crack);
  for (const GrowingFront& g : state_.fracture.fronts) last = std::max(last, g.front.crack);
  return last + 1;
}

// A pose for each grip; of one that does not move, none to be asked for.
std::vector<Pose> Simulation::grip_poses(double time) const {
  std::vector<Pose> poses(scene_.grips.size());
  for (std::size_t g = 0; g < poses.size(); ++g)
    if (!scene_.grips[g].motion.keys.empty()) poses[g] = scene_.grips[g].motion.at(time);
  return poses;
}

// Held nodes are put where their grip will be at the end of the step; what they do to the others is the step's
// business.
void Simulation::move_grips(double dt) {
  std::fill(environment_.fixed.begin(), environment_.fixed.end(), 0);
  const double end = state_.time + dt;
  const std::vector<Pose> poses = grip_poses(end);
  for (const auto& [i, g] : gripped_) {
    const Grip& grip = scene_.grips[g];
    if (grip.release && !grip.motion.keys.empty() && end > grip.motion.keys.back().time) continue;
    environment_.fixed[i.index()] = 1;
    const Vec3 &x = body_.nodes.position[i.index()], middle = grip.middle();
    if (!grip.motion.keys.empty()) state_.motion.displacement[i.index()] = middle + poses[g] * Vec3(x - middle) - x;
  }
}

// Thick blades, where they will be at the end of the step.
void Simulation::push(double dt) {
  wedge_ = {};
  std::vector<double> mass;
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    const Blade& blade = scene_.blades[b];
    if (!(blade.thickness > 0) || !blade.active(state_.time)) continue;
    for (std::size_t i = mass.size(); i < body_.nodes.size(); ++i) mass.push_back(solid_.mass(NodeId(i)));
    wedge_.add(b, blade, blade.motion.at(state_.time + dt), body_.nodes.position, state_.motion.displacement,
               environment_.clearance, mass, blade.stiffness);
  }
  if (!wedge_.empty()) environment_.contact.push_back(&wedge_);
}

void Simulation::meet_obstacles(double dt, FrameStats& work) {
  Stopwatch watch;
  const std::span<const Vec3> at =
      obstacles_.any() ? collisions_->wanted(body_, state_.motion) : std::span<const Vec3>();
  obstacles_.begin(scene_, body_, solid_, collisions_->weights(), at, state_.part, state_.motion, state_.time, dt,
                   environment_);
  collisions_->begin(body_, solid_, state_.motion, dt, environment_);
  work.contact_seconds += watch.lap();
}

void Simulation::integrate(double dt, FrameStats& work) {
  Stopwatch watch;
  solid_.settle(body_, state_.motion);
  const StepReport report = scene_.implicit ? solid_.step_implicit(state_.motion, dt, environment_, scene_.accuracy)
                                            : solid_.step_explicit(state_.motion, dt, environment_);
  const std::vector<Pose> from = grip_poses(state_.time), to = grip_poses(state_.time + dt);
  for (const auto& [i, g] : gripped_) {
    const Grip& grip = scene_.grips[g];
    if (!environment_.fixed[i.index()] || grip.motion.keys.empty()) continue;
    const Vec3 arm = body_.nodes.position[i.index()] - grip.middle();
    state_.motion.velocity[i.index()] = (to[g] * arm - from[g] * arm) / dt;
  }
  work.blade_force.resize(scene_.blades.size(), Vec3::Zero());
  const auto reaction = wedge_.reaction(state_.motion.displacement, scene_.blades.size());
  for (std::size_t b = 0; b < reaction.size(); ++b) work.blade_force[b] += dt * scene_.frame_rate * reaction[b];
  obstacles_.reaction(state_.motion, dt * scene_.frame_rate, work);
  work.newton += static_cast<std::size_t>(report.newton), work.cg += static_cast<std::size_t>(report.cg), ++work.steps;
  work.energy = report.energy;
  work.mechanics_seconds += watch.lap();
}

void Simulation::collide(const std::vector<Vec3>& before, double dt, FrameStats& work) {
  Stopwatch watch;
  collisions_->resolve(body_, solid_, before, dt, environment_, state_.motion, work.contact);
  work.contact_seconds += watch.lap();
}

void Simulation::fracture(double dt, FrameStats& work) {
  if (!scene_.fracture.on || state_.time < scene_.fracture.start) return;
  Stopwatch watch;
  const auto others = [&] { return work.split_seconds() + work.mechanics_seconds + work.contact_seconds; };
  const double splitting = others();
  step_fracture(
      scene_.fracture, state_.part, body_, solid_, state_.motion, dt, state_.fracture,
      [&](FrontState& front, const std::vector<Vec3>& next) { return split_step(front, next, work); }, &work.fracture);
  work.fracture_seconds += watch.lap() - (others() - splitting);
}

// One time step, a phase a line.
void Simulation::step(double dt, FrameStats& work) {
  cut(dt, work);
  const std::vector<Vec3> before = state_.motion.displacement;
  move_grips(dt);
  environment_.contact.clear();
  push(dt);
  meet_obstacles(dt, work);
  integrate(dt, work);
  collide(before, dt, work);
  state_.time += dt;
  fracture(dt, work);
}

FrameStats Simulation::advance_frame(const Progress& progress) {
  FrameStats work;
  const double frame_time = 1 / scene_.frame_rate;
  const int steps = std::max(1, static_cast<int>(std::ceil(frame_time / scene_.dt - 1e-9)));
  for (int s = 0; s < steps; ++s) {
    report(progress, "", static_cast<std::size_t>(s), static_cast<std::size_t>(steps));
    state_.time = (state_.frame + double(s) / steps) * frame_time;
    step(frame_time / steps, work);
    for (std::size_t i = 0; i < state_.motion.displacement.size(); ++i)
      if (!state_.motion.displacement[i].allFinite())
        throw GeometryError("node " + std::to_string(i) + " has left all bounds at time " +
                            std::to_string(state_.time) + "; reduce the time step");
  }
  ++state_.frame;
  state_.surface = collisions_->rows(body_);
  state_.total += work;
  return work;
}

TriangleMesh Simulation::surface(const TriangleMesh* model) const {
  std::vector<std::uint32_t> rows;
  TriangleMesh mesh = body_.surface.two_sided(&rows);
  if (model) carry(*model, mesh);
  mesh.attributes.normal.clear();
  if (collisions_->on()) {
    mesh.vertices = collisions_->rows(body_);
    return mesh;
  }
  const auto gradient = solid_.gradients(state_.motion.displacement);
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> nodes;
    for (std::size_t v = begin; v < end; ++v) {
      if (rows[v] == ~0u) continue;
      bound_nodes(body_, SurfaceVertexId(v), nodes);
      Vec3& x = mesh.vertices[rows[v]];
      if (!nodes.empty()) x += displacement_at(x, nodes, body_.nodes, state_.motion.displacement, gradient);
    }
  });
  return mesh;
}

}  // namespace geo
