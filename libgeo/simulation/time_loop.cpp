// Each phase begins with the scope that counts its seconds. Phases that read the same data run
// beside each other.
#include "simulation/time_loop.h"

#include <algorithm>
#include <string>
#include <utility>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "simulation/fracture_step.h"
#include "simulation/mapped_places.h"
#include "simulation/scene_body.h"
#include "simulation/timed.h"

namespace geo {
namespace {

CrackOptions crack_options(const Scene& scene, const Body& body) {
  CrackOptions options;
  options.seed = scene.seed;
  options.snap_edges = snap_spacings * body.finest_spacing / body.surface.extent().diagonal();
  return options;
}

void require_finite(const RunState& state) {
  for (std::size_t i = 0; i < state.motion.displacement.size(); ++i)
    if (!state.motion.displacement[i].allFinite())
      throw GeometryError("node " + std::to_string(i) + " has left all bounds at time " + std::to_string(state.time) +
                          "; reduce the time step");
}

// The work that weight would do on the way back to rest, J.
double weight_energy(const Solid& solid, const Vec3& gravity, const std::vector<Vec3>& displacement) {
  double energy = 0;
  for (std::uint32_t i = 0; i < displacement.size(); ++i)
    energy -= solid.mass(NodeId(i)) * gravity.dot(displacement[i]);
  return energy;
}

}  // namespace

TimeLoop::TimeLoop(RunData& run)
    : run_(run),
      obstacles_(run.scene),
      loads_(run.scene, run.body),
      collisions_(run.scene, run.body, run.solid.nodes(), run.state.surface),
      writer_(run.body, run.state.body_index, crack_options(run.scene, run.body),
              CrackFollowers{.solid = run.solid,
                             .motion = run.state.motion,
                             .way = way_,
                             .collisions = collisions_,
                             .loads = loads_,
                             .sleep = sleep_}),
      cuts_(run.scene, run.body, run.state, writer_),
      bonds_(run.body, run.state, writer_),
      skin_(run.scene, run.body),
      edges_(run.scene),
      sleep_(run.scene, run.state) {
  hold_material(run.state.time);
  apply_changes(run.state.time);
}

// Applies the changes of the scene's values that are due. Returns whether there were any.
bool TimeLoop::apply_changes(double time) {
  if (!run_.changes.apply(run_.scene, time)) return false;
  run_.solid.set_materials(materials_of(run_.scene, run_.state.body_index));
  collisions_.set_friction(run_.scene.contact.friction);
  loads_.follow_scene();
  return true;
}

FrameStats TimeLoop::advance_frame(const Progress& progress) {
  Scene& scene = run_.scene;
  RunState& state = run_.state;
  FrameStats stats;
  if (apply_changes(state.frame * (1 / scene.frame_rate))) sleep_.wake_all();
  const double frame_time = 1 / scene.frame_rate;
  const int steps = scene.steps_per_frame();
  const auto time = [&](double s) { return (state.frame + s / steps) * frame_time; };
  for (int s = 0; s < steps; ++s) {
    report(progress, "", static_cast<std::size_t>(s), static_cast<std::size_t>(steps));
    advance(s, frame_time / steps, time, stats);
  }
  ++state.frame;
  state.surface = collisions_.living_positions(run_.body);
  stats.sheet.crumbs = writer_.crumbs();
  stats.kinetic = run_.solid.nodes().kinetic_energy(state.motion);
  stats.weight = weight_energy(run_.solid.nodes(), scene.gravity, state.motion.displacement);
  for (const GrowingFront& front : state.fracture.fronts) stats.fracture.tips.push_back(tip_of(front));
  state.total += stats;
  return stats;
}

// Makes the s-th time step of a frame, halved as often as breaking bonds need it. A step that is
// found to be too long, or that Newton's method does not find, is made again, shorter; after some
// calm steps, they are longer again.
template <class Time>
void TimeLoop::advance(int s, double dt, const Time& time, FrameStats& stats) {
  constexpr std::uint32_t units = 1u << max_halvings, calm_steps = 4;
  GluedBonds& glued = run_.state.glued;
  for (std::uint32_t at = 0; at < units;) {
    const std::uint32_t length = units >> glued.halvings;
    const std::uint32_t next = at + length;
    const double end = next == units ? s + 1 : s + double(next) / units;
    const std::size_t broken = stats.fracture.broken;
    const Outcome outcome =
        step({.begin = time(s + double(at) / units), .end = time(end), .dt = dt * length / units}, stats);
    if (outcome != Outcome::taken) {
      glued.halvings = std::min(glued.halvings + (outcome == Outcome::too_long ? 2 : 1), max_halvings);
      glued.calm = 0;
      continue;
    }
    at = next;
    glued.calm = stats.fracture.broken > broken ? 0 : glued.calm + 1;
    if (glued.halvings == 0 || glued.calm < calm_steps || at % (2 * length) != 0) continue;
    --glued.halvings;
    glued.calm = 0;
  }
}

// Too long: for what breaks in it. Not found: by Newton's method.
TimeLoop::Outcome TimeLoop::step(const TimeStep& step, FrameStats& stats) {
  run_.state.time = step.begin;
  if (apply_changes(step.begin)) sleep_.wake_all();
  const std::vector<Vec3> before = run_.state.motion.displacement;
  std::optional<State> start;  // to go back to
  if (may_break()) start = run_.state.motion;
  loads_.begin_step(step, run_.solid.nodes(), run_.state.motion);
  if (sleep_.on()) {
    if (GrippedNodes::change(run_.scene.grips, step.begin, step.end)) sleep_.wake_all();
    sleep_.begin_step(run_.solid.nodes(), before, step.dt, loads_.environment());
    if (sleep_.all() && last_step_.steps > 0 && !cuts_.any_at(step.begin) && !Obstacles::any_moves(run_.scene, step)) {
      sleep_on(step, stats);
      return Outcome::taken;
    }
  }
  std::optional<ContactStep> contact = begin_contact(step, stats);
  const StepReport report = move_nodes(step, stats);
  if (start && (!report.converged || is_too_long(step, *start, stats))) {
    run_.state.motion = std::move(*start);
    run_.solid.whole().set_rotations(run_.state.motion);
    return report.converged ? Outcome::too_long : Outcome::not_found;
  }
  take(report, step, stats);
  move_surface(step, std::move(contact), before, stats);
  run_.state.time = step.end;
  cut(step, stats);
  grow_cracks(step.dt, stats);
  break_bonds(step.dt, stats);
  require_finite(run_.state);
  return Outcome::taken;
}

// A step in which all sleeps: forces and energy are those of the last one that was computed.
void TimeLoop::sleep_on(const TimeStep& step, FrameStats& stats) {
  add_obstacle_forces(step.dt * run_.scene.frame_rate, stats);
  stats.blade_force.resize(run_.scene.blades.size(), Vec3::Zero());
  stats.pull_force.resize(run_.scene.pulls.size(), Vec3::Zero());
  stats.stitch_force.resize(run_.scene.stitches.size(), 0);
  stats.energy = last_step_.energy;
  ++stats.steps;
  run_.state.time = step.end;
}

// Those of the last computed step, times `share`.
void TimeLoop::add_obstacle_forces(double share, FrameStats& stats) const {
  const auto add = [&](std::vector<Vec3>& to, const std::vector<Vec3>& from) {
    to.resize(from.size(), Vec3::Zero());
    for (std::size_t i = 0; i < from.size(); ++i) to[i] += share * from[i];
  };
  add(stats.obstacle_force, last_step_.obstacle_force);
  add(stats.obstacle_torque, last_step_.obstacle_torque);
}

bool TimeLoop::is_too_long(const TimeStep& step, const State& before, FrameStats& stats) {
  const TimedRest rest(stats, &FrameStats::fracture_seconds);
  return bonds_.is_too_long(run_.solid.whole(), before, run_.scene.gravity, run_.scene.contact.friction, step.dt);
}

// Whether bonds may break now.
bool TimeLoop::may_break() const {
  const FractureOptions& options = run_.scene.fracture;
  return bonds_.any_left() && (!options.on || run_.state.time >= options.start);
}

// Obstacles that move wake what they come near.
void TimeLoop::add_obstacles(const TimeStep& step, double stopping) {
  const Solid& nodes = run_.solid.nodes();
  const State& motion = run_.state.motion;
  obstacles_.add_potentials({.scene = run_.scene,
                             .body = run_.body,
                             .solid = nodes,
                             .weights = collisions_.weights(),
                             .surface = collisions_.targets(motion),
                             .motion = motion,
                             .time = step.begin,
                             .dt = step.dt,
                             .stopping = stopping},
                            loads_.environment());
  for (const Potential* potential : obstacles_.moving())
    if (sleep_.on()) sleep_.wake(nodes, *potential, loads_.environment());
}

// Adds the pressure of edges on their fronts, which wakes what they touch.
void TimeLoop::add_edges(const TimeStep& step) {
  const Solid& nodes = run_.solid.nodes();
  edges_.begin_step(step, run_.body, nodes, run_.state, collisions_.weights());
  if (edges_.empty()) return;
  loads_.environment().contact.push_back(&edges_);
  if (sleep_.on()) sleep_.wake(nodes, edges_, loads_.environment());
}

// Adds obstacles and self-contact to the loads. The result owns the potential of self-contact.
// Contact needs the nodes of the solid, not its points, which are brought up to date beside it.
std::optional<ContactStep> TimeLoop::begin_contact(const TimeStep& step, FrameStats& stats) {
  const TimedRest rest(stats, &FrameStats::mechanics_seconds);
  std::optional<ContactStep> contact;
  const Solid& nodes = run_.solid.nodes();
  const State& motion = run_.state.motion;
  // Contact gets softer where nothing is left that may break: its energy falls.
  const double stopping = bonds_.any_left() ? std::min(step.dt, bonds_.shortest_step(nodes)) : step.dt;
  const double whole = 1 / run_.scene.frame_rate / run_.scene.steps_per_frame();
  const auto begin = [&] {
    const Timed timed(stats.contact_seconds);
    const bool resists = edges_.any_at(step.begin);
    if (obstacles_.any() || bonds_.any() || skin_.any() || resists)
      collisions_.update_weights(run_.body, nodes, motion);
    if (resists) add_edges(step);
    if (skin_.any()) skin_.begin_step(step, run_.body, nodes, collisions_.weights());
    if (!skin_.empty()) loads_.environment().contact.push_back(&skin_);
    cohesion_.begin_step(run_.body, run_.state.glued, collisions_.weights());
    if (!cohesion_.empty()) loads_.environment().contact.push_back(&cohesion_);
    if (obstacles_.any()) add_obstacles(step, stopping);
    const ContactPace pace{.stopping = stopping, .whole_step = whole};
    Environment& environment = loads_.environment();
    contact = collisions_.begin_step(run_.body, nodes, motion, step.dt, pace, environment);
  };
  parallel_invoke([&] { run_.solid.whole(); }, begin);
  return contact;
}

StepReport TimeLoop::move_nodes(const TimeStep& step, FrameStats& stats) {
  const Timed timed(stats.mechanics_seconds);
  const Scene& scene = run_.scene;
  State& motion = run_.state.motion;
  hold_material(step.end);
  Solid& solid = run_.solid.whole();
  const Environment& environment = loads_.environment();
  // Contacts are found anew for a part of a step, unlike for its substeps.
  const bool may_be_divided = may_break() && run_.state.glued.halvings < max_halvings;
  const StepReport report =
      scene.implicit ? solid.step_implicit(motion, step.dt, environment, scene.accuracy,
                                           may_be_divided ? Division::refused : Division::allowed, scene.scheme)
                     : solid.step_explicit(motion, step.dt, environment);
  stats.newton += static_cast<std::size_t>(report.newton);
  stats.cg += static_cast<std::size_t>(report.cg);
  return report;
}

// The step is long enough: all that it has done counts.
void TimeLoop::take(const StepReport& report, const TimeStep& step, FrameStats& stats) {
  State& motion = run_.state.motion;
  const double share = step.dt * run_.scene.frame_rate;
  loads_.end_step(step, share, motion, stats);
  stats.fracture.spent += cohesion_.end_step(motion.displacement, run_.state.glued);
  last_step_ = {};
  obstacles_.add_reactions(motion, 1, last_step_);
  last_step_.energy = report.energy;
  last_step_.steps = 1;
  add_obstacle_forces(share, stats);
  if (skin_.any()) skin_.end_step(motion.displacement, share, stats);
  if (edges_.any_at(step.begin)) edges_.end_step(motion.displacement, share, stats);
  if (sleep_.on()) sleep_.end_step(run_.solid.nodes(), step.dt);
  ++stats.steps;
  stats.energy = report.energy;
}

// In the boxes of the grips at a time.
void TimeLoop::hold_material(double time) {
  run_.solid.whole().hold(run_.body, GrippedNodes::boxes(run_.scene.grips, time));
}

// Moves the surface after the nodes, without crossings. `before`: displacements of the nodes at the
// beginning of the step. Implicit steps end here for the nodes, which a crack that begins does not
// change either: both run beside each other. Impulses of explicit steps still change the nodes.
void TimeLoop::move_surface(const TimeStep& step, std::optional<ContactStep> contact, const std::vector<Vec3>& before,
                            FrameStats& stats) {
  State& motion = run_.state.motion;
  const auto follow_nodes = [&] {
    const Timed timed(stats.contact_seconds);
    stats.contact += collisions_.finish_step(std::move(contact), run_.body, run_.solid.nodes(), before, step.dt,
                                             loads_.environment(), motion);
  };
  cuts_.drop_idle(step.begin);
  if (!cuts_.any_at(step.begin)) return follow_nodes();
  if (!run_.scene.implicit) {
    follow_nodes();
    way_ = NodeWay(before, motion.displacement);
    return;
  }
  const TimedRest rest(stats, &FrameStats::front_seconds);
  way_ = NodeWay(before, motion.displacement);
  parallel_invoke([&] { cuts_.begin_first(moved_body(step), stats); }, follow_nodes);
}

// Cuts by blades.
void TimeLoop::cut(const TimeStep& step, FrameStats& stats) {
  if (!cuts_.any_at(step.begin)) return;
  {
    const TimedRest rest(stats, &FrameStats::front_seconds);
    cuts_.make_all(moved_body(step), stats);
    way_ = NodeWay();
  }
  if (run_.state.motion.plastic.empty()) return;
  const Timed timed(stats.mechanics_seconds);
  run_.solid.whole();  // plastic strains are of points
}

MovedBody TimeLoop::moved_body(const TimeStep& step) const {
  return {.body = run_.body,
          .solid = run_.solid.nodes(),
          .motion = run_.state.motion,
          .way = way_,
          .begin = step.begin,
          .end = step.end};
}

// Starts and grows cracks by stress, which is of the solid's points.
void TimeLoop::grow_cracks(double dt, FrameStats& stats) {
  const FractureOptions& options = run_.scene.fracture;
  if (!options.on || !options.any_fronts() || run_.state.time < options.start) return;
  const TimedRest rest(stats, &FrameStats::fracture_seconds);
  const auto bring_up_to_date = [&]() -> const Solid& {
    const Timed timed(stats.mechanics_seconds);
    return run_.solid.whole();
  };
  const auto split = [&](FrontState& front, const std::vector<Vec3>& next) {
    std::optional<WrittenCrack> written = writer_.write(front, next, stats);
    if (!written) return false;
    front = std::move(written->front);
    bring_up_to_date();
    return true;
  };
  step_fracture({.options = options,
                 .body_index = run_.state.body_index,
                 .body = run_.body,
                 .solid = bring_up_to_date(),
                 .motion = run_.state.motion,
                 .dt = dt},
                run_.state.fracture, split, &stats.fracture);
}

// Opens glued walls whose load is too high. Stress is of the solid's points.
void TimeLoop::break_bonds(double dt, FrameStats& stats) {
  if (!may_break()) return;
  const TimedRest rest(stats, &FrameStats::fracture_seconds);
  const auto solid = [&]() -> const Solid& {
    const Timed timed(stats.mechanics_seconds);
    return run_.solid.whole();
  };
  bonds_.step(solid(), run_.scene.contact.friction, dt, stats);
}

}  // namespace geo
