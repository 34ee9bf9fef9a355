// Simulation of kerf/simulation.h. A time step: place grips, add contact, integrate, move the
// surface, cut by blades, grow cracks by stress. Self-contact may veto a crack step before its
// commit; the step is then counted as refused.
#include "kerf/simulation.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "contact/response/blade_penalty.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/blade_way.h"
#include "simulation/collisions.h"
#include "simulation/edge_retreat.h"
#include "simulation/edge_runs.h"
#include "simulation/existing_cuts.h"
#include "simulation/fracture_step.h"
#include "simulation/front_anchor.h"
#include "simulation/grips.h"
#include "simulation/mapped_places.h"
#include "simulation/obstacles.h"
#include "simulation/pulls.h"
#include "simulation/scene_body.h"
#include "simulation/scene_changes.h"

namespace geo {
namespace {

// A sheet snaps to vertices and edges nearer than this, in spacings of the finest nodes: a
// twentieth of what a front deviates from its blade's edge (edge_runs.cpp), and far above the
// slivers that weights of nodes fold.
constexpr double snap_spacings = 0.001;

// The state with a body index for each node. Throws InputError where it does not fit.
RunState checked(const Scene& scene, const Body& body, RunState state) {
  const std::size_t n = body.nodes.size();
  if (state.body_index.empty()) state.body_index.assign(n, 0);
  const bool known =
      std::all_of(state.body_index.begin(), state.body_index.end(), [&](auto b) { return b < scene.bodies.size(); });
  if (state.motion.displacement.size() != n || state.motion.velocity.size() != n || state.body_index.size() != n ||
      !known || state.fronts.size() != scene.blades.size())
    throw InputError("the checkpoint does not belong to this scene");
  return state;
}

// A key with this rotation, whose axis is arbitrary where there is none.
Motion::Key key_at(double time, const Pose& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  return {.time = time,
          .position = pose.position,
          .axis = turn.angle() == 0 ? Vec3(Vec3::UnitZ()) : turn.axis(),
          .angle = turn.angle() * 180 / std::numbers::pi};
}

// From the present pose at time `from` to `pose` at time `to`.
Motion towards(const Motion& present, double from, double to, const Pose& pose) {
  return {{key_at(from, present.at(from)), key_at(to, pose)}};
}

// Runs two functions in parallel. Returns the time that they take less that of `timed`, which adds
// its own to `seconds`.
double seconds_beside(const double& seconds, const std::function<void()>& other, const std::function<void()>& timed) {
  const double before = seconds;
  Stopwatch watch;
  parallel_invoke(other, timed);
  return std::max(0.0, watch.lap() - (seconds - before));
}

void append(Motion& motion, const Motion::Key& key) {
  if (!motion.keys.empty() && !(motion.keys.back().time < key.time))
    throw InputError("a motion has a key at this time, or later");
  motion.keys.push_back(key);
}

}  // namespace

// All that a run consists of, and the phases of a time step.
struct Simulation::Impl {
  // One time step. Its end is the begin of the next, to the bit: there, motions have their keys.
  struct TimeStep {
    double begin, end, dt;  // s
  };
  // A front and its next position.
  struct Advance {
    bool rests = false;           // the edge is where the front is: nothing is cut
    EdgeFront edge;               // with a point for each of `to`
    std::vector<Vec3> to;         // material positions
    std::vector<double> spacing;  // of the nodes there, model units
    double deviation = 0;         // see sheet_deviation()
    std::size_t retreating = 0;   // points of `to` that hold_retreating() held
    bool is_begun = false;
    std::optional<CrackTransaction> split;  // once begun; none: it is refused
  };
  // A cut by a blade: its runs in the material, and the advance of each.
  struct PlannedCut {
    std::vector<std::vector<EdgePoint>> runs;
    std::vector<Advance> advances;
  };
  // The first cut of the first blade that is active in a time step.
  struct FirstCut {
    std::size_t blade;
    int cuts;  // by this blade in the step
    PlannedCut plan;
  };

  Impl(const Scene& scene_in, Body body_in, RunState state_in);
  void restore(Body new_body, RunState new_state);
  void reset_contact();
  void reset_environment();
  void hold_material(double time);

  void apply_changes(double time);
  void step(const TimeStep& step, FrameStats& stats);
  MovedBody moved_body(const TimeStep& step) const {
    return {.body = body, .solid = solid, .motion = state.motion, .way = way, .begin = step.begin, .end = step.end};
  }
  void begin_first_cut(const TimeStep& step, std::optional<FirstCut>& first, FrameStats& stats);
  void cut(const TimeStep& step, std::optional<FirstCut> first, FrameStats& stats);
  std::vector<std::vector<EdgePoint>> map_edge(const MovedBody& moved, std::size_t blade, double fraction,
                                               double before);
  int begin_cuts(const MovedBody& moved, std::size_t blade);
  PlannedCut plan_cut(const MovedBody& moved, std::size_t blade, int k, int cuts);
  void make_cut(std::size_t blade, PlannedCut plan, FrameStats& stats);
  Advance advance_of(const EdgeFront& front, std::span<const EdgePoint> run, const MapAt& half, const Blade& blade,
                     const FrontAnchor& anchor) const;
  void begin(Advance& advance, FrameStats& stats);
  std::optional<std::vector<FaceId>> split_step(FrontState& front, const std::vector<Vec3>& next, FrameStats& stats);
  std::optional<CrackTransaction> begin_step(const FrontState& front, const std::vector<Vec3>& next, FrameStats& stats);
  std::optional<std::vector<FaceId>> finish_step(FrontState& front, CrackTransaction step, FrameStats& stats);
  void apply_delta(const BodyDelta& delta, std::optional<EmbeddingPlan> plan, FrameStats& stats);
  void update_points();
  std::int32_t unused_crack() const;
  void add_wedges();
  std::optional<ContactStep> begin_contact(double dt, FrameStats& stats);
  void integrate(const TimeStep& step, FrameStats& stats);
  void finish_contact(std::optional<ContactStep> contact, const std::vector<Vec3>& before, double dt,
                      FrameStats& stats);
  void fracture(double dt, FrameStats& stats);
  void require_finite() const;
  double weight_energy() const;
  double time_of(int frame) const { return frame * (1 / scene.frame_rate); }

  Scene scene;
  SceneChanges changes;
  RunState state;
  Body body;
  Solid solid;
  Environment environment;
  GrippedNodes gripped;
  BladePenalty wedge;
  PullPotential pull;
  Obstacles obstacles;
  std::optional<Collisions> collisions;
  NodeWay way;              // of this time step, while blades cut
  std::mutex points_guard;  // held by update_points()
  std::size_t crumbs = 0;
  bool cut_since_build = false;  // of the solid
  bool nodes_changed = false;    // since reset_environment()
};

Simulation::Impl::Impl(const Scene& scene_in, Body body_in, RunState state_in)
    : scene(scene_in),
      changes(scene),
      state(checked(scene, body_in, std::move(state_in))),
      body(std::move(body_in)),
      solid(body, materials_of(scene, state.body_index)),
      obstacles(scene) {
  solid.set_rotations(state.motion);
  reset_contact();
  hold_material(state.time);
  apply_changes(state.time);
}

void Simulation::Impl::restore(Body new_body, RunState new_state) {
  state = checked(scene, new_body, std::move(new_state));
  body = std::move(new_body);
  if (std::exchange(cut_since_build, false)) solid = Solid(body, materials_of(scene, state.body_index));
  solid.set_rotations(state.motion);
  obstacles = Obstacles(scene);
  environment = {};
  wedge = {};
  pull = {};
  reset_contact();
  hold_material(state.time);
  changes.revert(scene);
  apply_changes(state.time);
}

// Applies the changes that are due; whether there were any.
void Simulation::Impl::apply_changes(double time) {
  if (!changes.apply(scene, time)) return;
  solid.set_materials(materials_of(scene, state.body_index));
  collisions->set_friction(scene.contact.friction);
  reset_environment();
}

// From body, state and solid as they are.
void Simulation::Impl::reset_contact() {
  if (solid.size() != body.nodes.size()) throw InputError("the checkpoint does not belong to this scene");
  reset_environment();
  collisions.emplace(scene, body, solid, state.surface);
  crumbs = count_crumbs(body);
}

// All that acts on the nodes as they are now, except contact.
void Simulation::Impl::reset_environment() {
  nodes_changed = false;
  environment.gravity = scene.gravity;
  environment.fixed.assign(body.nodes.size(), 0);
  gripped = GrippedNodes(scene.grips, body.nodes);
}

// In the boxes of the grips at a time. Precondition: the solid's points are up to date.
void Simulation::Impl::hold_material(double time) { solid.hold(body, GrippedNodes::boxes(scene.grips, time)); }

// Updates nodes and contact after a crack step. `plan`: of the surface, empty without self-contact.
// Weights of the surface wait for the next time step. So do points, unless cracks grow by stress.
void Simulation::Impl::apply_delta(const BodyDelta& delta, std::optional<EmbeddingPlan> plan, FrameStats& stats) {
  if (delta.crack.empty()) return;
  Stopwatch watch;
  cut_since_build = true;
  nodes_changed = true;
  solid.update_nodes(body, delta, state.motion);
  if (scene.fracture.on) update_points();
  for (const NodeId d : delta.donors) state.body_index.push_back(std::uint32_t(state.body_index[d.index()]));
  way.add_nodes(delta.donors);
  if (!delta.detached.empty()) crumbs = count_crumbs(body);
  stats.mechanics_seconds += watch.lap();
  if (collisions) collisions->commit(std::move(plan), body, delta);
  pull.invalidate();
  stats.contact_seconds += watch.lap();
}

// Makes the solid's points follow all crack steps, unless they do.
void Simulation::Impl::update_points() {
  const std::lock_guard lock(points_guard);
  solid.update_points(body, state.motion);
}

// One step of a crack. Returns its new faces; nothing, and counts it, where it cannot be made.
std::optional<std::vector<FaceId>> Simulation::Impl::split_step(FrontState& front, const std::vector<Vec3>& next,
                                                                FrameStats& stats) {
  std::optional<CrackTransaction> step = begin_step(front, next, stats);
  return step ? finish_step(front, std::move(*step), stats) : std::nullopt;
}

// The first part of split_step().
std::optional<CrackTransaction> Simulation::Impl::begin_step(const FrontState& front, const std::vector<Vec3>& next,
                                                             FrameStats& stats) {
  CrackOptions options;
  options.seed = scene.seed;
  options.snap_edges = snap_spacings * body.finest_spacing / body.surface.extent().diagonal();
  try {
    return CrackTransaction(body, front, next, options, &stats.split);
  } catch (const GeometryError&) {
    ++stats.refused;
    return {};
  }
}

// The second part.
std::optional<std::vector<FaceId>> Simulation::Impl::finish_step(FrontState& front, CrackTransaction step,
                                                                 FrameStats& stats) {
  try {
    std::optional<EmbeddingPlan> plan;
    const StepVeto check =
        collisions ? collisions->embedding_check(body, solid, state.motion, plan, stats.contact_seconds) : StepVeto();
    const BodyDelta delta = step.commit(front, check);
    apply_delta(delta, std::move(plan), stats);
    return delta.crack.new_crack_faces;
  } catch (const GeometryError&) {
    ++stats.refused;
    return {};
  }
}

// Plans the first cut of a time step that the nodes have made, and begins its first crack: changes
// the fronts of its blade and the body's complex. `first`: none where no blade is active.
// Precondition: `way`.
void Simulation::Impl::begin_first_cut(const TimeStep& step, std::optional<FirstCut>& first, FrameStats& stats) {
  const auto is_active = [&](const Blade& blade) { return blade.active(step.begin); };
  const auto blade = std::find_if(scene.blades.begin(), scene.blades.end(), is_active);
  if (blade == scene.blades.end()) return;
  const MovedBody moved = moved_body(step);
  first = FirstCut{static_cast<std::size_t>(blade - scene.blades.begin()), 0, {}};
  first->cuts = begin_cuts(moved, first->blade);
  first->plan = plan_cut(moved, first->blade, 1, first->cuts);
  if (first->plan.advances.empty() || first->plan.advances[0].rests) return;
  Advance& advance = first->plan.advances[0];
  begin(advance, stats);
  Stopwatch watch;
  if (advance.split) advance.split->prepare();
  stats.split.binding_seconds += watch.lap();
}

// Moves all blades through the time step that the nodes have just made. `first`: the first cut, if
// it has begun. Precondition: `way`.
void Simulation::Impl::cut(const TimeStep& step, std::optional<FirstCut> first, FrameStats& stats) {
  if (scene.blades.empty()) return;
  const MovedBody moved = moved_body(step);
  for (std::size_t b = 0; b < scene.blades.size(); ++b) {
    if (!scene.blades[b].active(step.begin)) continue;
    const bool has_begun = first && first->blade == b;
    Stopwatch watch;
    const int cuts = has_begun ? first->cuts : begin_cuts(moved, b);
    for (int k = 1; k <= cuts; ++k) {
      PlannedCut plan = has_begun && k == 1 ? std::move(first->plan) : plan_cut(moved, b, k, cuts);
      stats.front_seconds += watch.lap();
      make_cut(b, std::move(plan), stats);
      watch.lap();
    }
  }
  way = NodeWay();
  if (state.motion.plastic.empty()) return;
  Stopwatch watch;  // plastic strains are of points
  update_points();
  stats.mechanics_seconds += watch.lap();
}

// Maps the edge of a blade that has no fronts yet. Returns the number of its cuts in the step.
int Simulation::Impl::begin_cuts(const MovedBody& moved, std::size_t b) {
  if (state.fronts[b].empty()) map_edge(moved, b, 0, 0);
  return number_of_cuts(moved, scene.blades[b], state.fronts[b]);
}

// The runs of a blade's edge in the material at a fraction of a time step. Its fronts become those
// that the runs continue; a run without one gets a new front. `before`: the fraction at the cut
// before, where a front begins that comes out of a cut.
std::vector<std::vector<EdgePoint>> Simulation::Impl::map_edge(const MovedBody& moved, std::size_t b, double fraction,
                                                               double before) {
  const Blade& blade = scene.blades[b];
  std::vector<EdgeFront>& fronts = state.fronts[b];
  const MapAt at(moved, blade, fraction);
  std::vector<std::vector<EdgePoint>> runs;
  if (blade.closed) {
    runs.push_back(closed_run(at.map(), body, blade, at.pose(), fronts));
    if (fronts.empty()) fronts.resize(1);
  } else {
    runs = edge_runs(at.map(), body, blade, at.pose(), fronts);
    fronts = fronts_of(runs, fronts, body.surface);
  }
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (fronts[r].at.empty())
      fronts[r] =
          begin_edge(begin_of_run(moved, blade, before, runs[r], fronts), unused_crack(), blade.name, blade.closed);
  return runs;
}

// The advance of a blade's fronts to the end of cut k of a time step. All runs ask the map of the
// body as it is before any of them cuts.
Simulation::Impl::PlannedCut Simulation::Impl::plan_cut(const MovedBody& moved, std::size_t b, int k, int cuts) {
  const Blade& blade = scene.blades[b];
  PlannedCut plan{map_edge(moved, b, double(k) / cuts, (k - 1.0) / cuts), {}};
  plan.advances.resize(plan.runs.size());
  for (std::size_t r = 0; r < plan.runs.size(); ++r) plan.advances[r].rests = rests(state.fronts[b][r], plan.runs[r]);
  if (std::all_of(plan.advances.begin(), plan.advances.end(), [](const Advance& a) { return a.rests; })) return plan;
  std::optional<MapAt> start, half;
  parallel_invoke([&] { start.emplace(moved, blade, (k - 1.0) / cuts); },
                  [&] { half.emplace(moved, blade, (k - 0.5) / cuts); });
  for (std::size_t r = 0; r < plan.runs.size(); ++r) {
    if (plan.advances[r].rests) continue;
    const EdgeFront& front = state.fronts[b][r];
    const FrontAnchor anchor(body.surface, *start, blade, front);
    plan.advances[r] = advance_of(front, plan.runs[r], *half, blade, anchor);
  }
  return plan;
}

// Begins the crack of an advance.
void Simulation::Impl::begin(Advance& advance, FrameStats& stats) {
  advance.split = begin_step(advance.edge.front, advance.to, stats);
  advance.is_begun = true;
}

// Advances the fronts of a blade.
void Simulation::Impl::make_cut(std::size_t b, PlannedCut plan, FrameStats& stats) {
  for (std::size_t r = 0; r < plan.runs.size(); ++r) {
    Advance& advance = plan.advances[r];
    stats.sheet.retreating += advance.retreating;
    if (advance.rests) continue;
    ++stats.fronts;
    if (!advance.is_begun) begin(advance, stats);
    if (!advance.split) continue;
    const auto faces = finish_step(advance.edge.front, std::move(*advance.split), stats);
    if (!faces) continue;
    Stopwatch watch;
    collapse(advance.edge, plan.runs[r]);
    state.fronts[b][r] = std::move(advance.edge);
    stats.sheet.deviation = std::max(stats.sheet.deviation, advance.deviation);
    const double lowest = 0.1 * *std::min_element(advance.spacing.begin(), advance.spacing.end());
    stats.sheet.turning = std::max(stats.sheet.turning, sheet_turning(body.surface, *faces, lowest));
    stats.front_seconds += watch.lap();
  }
}

// The next position of a front. `run`: where the edge is; `half`: the map at half the time of the
// cut; `anchor`: of the front.
Simulation::Impl::Advance Simulation::Impl::advance_of(const EdgeFront& front, std::span<const EdgePoint> run,
                                                       const MapAt& half, const Blade& blade,
                                                       const FrontAnchor& anchor) const {
  Advance a;
  const MappedPlaces places(body.surface);
  std::vector<Vec3> mapped;
  a.edge = refined(front, run, mapped);
  for (const double at : a.edge.at) {
    const EdgePoint& p = nearest(run, at);
    a.to.push_back(anchor.corrected(p.at, p.material, p.spacing));
    a.spacing.push_back(p.spacing);
  }
  a.retreating = hold_retreating(body.surface, a.edge.front, a.spacing, a.to);
  cross_first(body.surface, a.edge.front, a.spacing, a.to);
  for (std::size_t i = 0; i < a.to.size(); ++i)
    if (a.to[i] != a.edge.front.points[i].position) a.to[i] = places.resolved(a.to[i]);
  a.rests = rests(a.edge.front, mapped, a.spacing, a.to);
  if (!a.rests) a.deviation = sheet_deviation(body, half, blade, a.edge, a.to, anchor);
  return a;
}

// A crack number that neither the complex nor a front uses.
std::int32_t Simulation::Impl::unused_crack() const {
  std::int32_t last = body.surface.crack_count();
  for (const auto& fronts : state.fronts)
    for (const EdgeFront& edge : fronts) last = std::max(last, edge.front.crack);
  for (const GrowingFront& g : state.fracture.fronts) last = std::max(last, g.front.crack);
  return last + 1;
}

// Adds the wedges of thick blades. They are where their cut is: the edge cuts on at the end of the
// step.
void Simulation::Impl::add_wedges() {
  wedge = {};
  const BladeNodes nodes{.position = body.nodes.position,
                         .displacement = state.motion.displacement,
                         .radius = body.nodes.radius,
                         .surface = [&](std::size_t i) { return surface_distance(body, NodeId(i)); },
                         .mass = [&](std::size_t i) { return solid.mass(NodeId(i)); }};
  for (std::size_t b = 0; b < scene.blades.size(); ++b) {
    const Blade& blade = scene.blades[b];
    if (!(blade.thickness > 0) || !blade.active(state.time)) continue;
    const Pose pose = blade.motion.at(state.time);
    wedge.add(b,
              {.edge = blade.at(state.time),
               .closed = blade.closed,
               .back = pose.rotation * blade.back,
               .thickness = blade.thickness,
               .stiffness = blade.stiffness},
              nodes);
  }
  if (!wedge.empty()) environment.contact.push_back(&wedge);
}

// Adds obstacles and self-contact. The result owns the potential of self-contact.
std::optional<ContactStep> Simulation::Impl::begin_contact(double dt, FrameStats& stats) {
  Stopwatch watch;
  if (obstacles.any()) {
    collisions->update_weights(body, solid);
    obstacles.add_potentials({.scene = scene,
                              .body = body,
                              .solid = solid,
                              .weights = collisions->weights(),
                              .surface = collisions->targets(state.motion),
                              .motion = state.motion,
                              .time = state.time,
                              .dt = dt},
                             environment);
  }
  std::optional<ContactStep> contact = collisions->begin_step(body, solid, state.motion, dt, environment);
  stats.contact_seconds += watch.lap();
  return contact;
}

void Simulation::Impl::integrate(const TimeStep& step, FrameStats& stats) {
  Stopwatch watch;
  const double dt = step.dt, share = dt * scene.frame_rate;
  hold_material(step.end);
  const StepReport report = scene.implicit ? solid.step_implicit(state.motion, dt, environment, scene.accuracy)
                                           : solid.step_explicit(state.motion, dt, environment);
  gripped.set_velocities(scene.grips, body.nodes, step.begin, step.end, state.motion);
  stats.blade_force.resize(scene.blades.size(), Vec3::Zero());
  const auto reaction = wedge.reaction(state.motion.displacement, scene.blades.size());
  for (std::size_t b = 0; b < reaction.size(); ++b) stats.blade_force[b] += share * reaction[b];
  stats.pull_force.resize(scene.pulls.size(), Vec3::Zero());
  const auto held = pull.reaction(state.motion.displacement, scene.pulls.size());
  for (std::size_t p = 0; p < held.size(); ++p) stats.pull_force[p] += share * held[p];
  obstacles.add_reactions(state.motion, share, stats);
  stats.newton += static_cast<std::size_t>(report.newton);
  stats.cg += static_cast<std::size_t>(report.cg);
  ++stats.steps;
  stats.energy = report.energy;
  stats.mechanics_seconds += watch.lap();
}

// Moves the surface after the nodes, without crossings. `before`: displacements of the nodes at the
// beginning of the step.
void Simulation::Impl::finish_contact(std::optional<ContactStep> contact, const std::vector<Vec3>& before, double dt,
                                      FrameStats& stats) {
  Stopwatch watch;
  stats.contact += collisions->finish_step(std::move(contact), body, solid, before, dt, environment, state.motion);
  stats.contact_seconds += watch.lap();
}

// Starts and grows cracks by stress.
void Simulation::Impl::fracture(double dt, FrameStats& stats) {
  if (!scene.fracture.on || state.time < scene.fracture.start) return;
  Stopwatch watch;
  const auto others = [&] { return stats.split_seconds() + stats.mechanics_seconds + stats.contact_seconds; };
  const double splitting = others();
  step_fracture(
      {.options = scene.fracture,
       .body_index = state.body_index,
       .body = body,
       .solid = solid,
       .motion = state.motion,
       .dt = dt},
      state.fracture,
      [&](FrontState& front, const std::vector<Vec3>& next) { return split_step(front, next, stats).has_value(); },
      &stats.fracture);
  stats.fracture_seconds += watch.lap() - (others() - splitting);
}

// One time step, phase by phase.
void Simulation::Impl::step(const TimeStep& step, FrameStats& stats) {
  state.time = step.begin;
  apply_changes(step.begin);
  if (nodes_changed) reset_environment();
  const std::vector<Vec3> before = state.motion.displacement;
  gripped.place(scene.grips, body.nodes, step.end, environment.fixed, state.motion);
  environment.contact.clear();
  add_wedges();
  pull.begin_step(scene.pulls, body, solid, step.begin, step.end);
  if (!pull.empty()) environment.contact.push_back(&pull);
  // Contact needs the nodes of the solid, not its points.
  std::optional<ContactStep> contact;
  stats.mechanics_seconds += seconds_beside(
      stats.contact_seconds, [&] { update_points(); }, [&] { contact = begin_contact(step.dt, stats); });
  integrate(step, stats);
  for (std::size_t b = 0; b < scene.blades.size(); ++b)
    if (!scene.blades[b].active(step.begin)) state.fronts[b].clear();
  std::optional<FirstCut> first;
  if (scene.blades.empty()) {
    finish_contact(std::move(contact), before, step.dt, stats);
  } else if (scene.implicit) {
    // Contact reads the nodes alone, which a crack that begins does not change.
    way = NodeWay(before, state.motion.displacement);
    const double before_split = stats.split_seconds();
    const double beside = seconds_beside(
        stats.contact_seconds, [&] { begin_first_cut(step, first, stats); },
        [&] { finish_contact(std::move(contact), before, step.dt, stats); });
    stats.front_seconds += std::max(0.0, beside - (stats.split_seconds() - before_split));
  } else {
    finish_contact(std::move(contact), before, step.dt, stats);
    way = NodeWay(before, state.motion.displacement);
  }
  state.time = step.end;
  cut(step, std::move(first), stats);
  fracture(step.dt, stats);
}

// The work that weight would do on the way back to rest, J.
double Simulation::Impl::weight_energy() const {
  double energy = 0;
  for (std::uint32_t i = 0; i < state.motion.displacement.size(); ++i)
    energy -= solid.mass(NodeId(i)) * scene.gravity.dot(state.motion.displacement[i]);
  return energy;
}

void Simulation::Impl::require_finite() const {
  for (std::size_t i = 0; i < state.motion.displacement.size(); ++i)
    if (!state.motion.displacement[i].allFinite())
      throw GeometryError("node " + std::to_string(i) + " has left all bounds at time " + std::to_string(state.time) +
                          "; reduce the time step");
}

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

const Body& Simulation::body() const { return impl_->body; }
const RunState& Simulation::state() const { return impl_->state; }
const Solid& Simulation::solid() const {
  impl_->update_points();
  return impl_->solid;
}
const Scene& Simulation::scene() const { return impl_->scene; }

void Simulation::restore(Body body, RunState state) { impl_->restore(std::move(body), std::move(state)); }

void Simulation::move_blade(std::size_t blade, const Pose& pose) {
  Motion& motion = impl_->scene.blades.at(blade).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

void Simulation::move_grip(std::size_t grip, const Pose& pose) {
  Motion& motion = impl_->scene.grips.at(grip).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

void Simulation::move_obstacle(std::size_t obstacle, const Pose& pose) {
  Motion& motion = impl_->scene.obstacles.at(obstacle).motion;
  motion = towards(motion, impl_->time_of(state().frame), impl_->time_of(state().frame + 1), pose);
}

std::size_t Simulation::add_blade(Blade blade) {
  if (blade.points.size() < (blade.closed ? 3 : 2))
    throw InputError("a blade has two points at least, three if closed");
  impl_->scene.blades.push_back(std::move(blade));
  impl_->state.fronts.emplace_back();
  return impl_->scene.blades.size() - 1;
}

std::size_t Simulation::add_grip(Grip grip) {
  grip.from = std::max(grip.from, impl_->time_of(state().frame));
  impl_->scene.grips.push_back(std::move(grip));
  impl_->reset_environment();
  return impl_->scene.grips.size() - 1;
}

std::size_t Simulation::add_pull(Pull pull) {
  if (pull.node && *pull.node >= body().nodes.size()) throw InputError("a pull holds a node that does not exist");
  impl_->scene.pulls.push_back(std::move(pull));
  return impl_->scene.pulls.size() - 1;
}

void Simulation::extend_blade(std::size_t blade, int frame, const Pose& pose) {
  append(impl_->scene.blades.at(blade).motion, key_at(impl_->time_of(state().frame + frame), pose));
}

// A pull that rests has two keys, however long it does: interpolation between equal positions is
// exact.
void Simulation::extend_pull(std::size_t pull, int frame, const Vec3& position) {
  Motion& motion = impl_->scene.pulls.at(pull).motion;
  append(motion,
         {.time = impl_->time_of(state().frame + frame), .position = position, .axis = Vec3::UnitZ(), .angle = 0});
  auto& keys = motion.keys;
  const auto n = keys.size();
  if (n < 3 || keys[n - 2].position != position || keys[n - 3].position != position) return;
  keys[n - 2].time = keys[n - 1].time;
  keys.pop_back();
}

void Simulation::end_grip(std::size_t grip) {
  double& until = impl_->scene.grips.at(grip).until;
  until = std::min(until, impl_->time_of(state().frame));
}

void Simulation::change(SceneChange change) {
  change.time = impl_->time_of(state().frame);
  if (const auto wrong = unfit(change); !wrong.empty()) throw InputError(wrong);
  impl_->scene.add_change(change);
}

FrameStats Simulation::advance_frame(const Progress& progress) {
  Impl& run = *impl_;
  FrameStats stats;
  run.apply_changes(run.time_of(run.state.frame));
  const double frame_time = 1 / run.scene.frame_rate;
  const int steps = run.scene.steps_per_frame();
  const auto time = [&](int s) { return (run.state.frame + double(s) / steps) * frame_time; };
  for (int s = 0; s < steps; ++s) {
    report(progress, "", static_cast<std::size_t>(s), static_cast<std::size_t>(steps));
    run.step({time(s), time(s + 1), frame_time / steps}, stats);
    run.require_finite();
  }
  ++run.state.frame;
  run.state.surface = run.collisions->living_positions(run.body);
  stats.sheet.crumbs = run.crumbs;
  stats.kinetic = run.solid.kinetic_energy(run.state.motion);
  stats.weight = run.weight_energy();
  run.state.total += stats;
  return stats;
}

TriangleMesh Simulation::surface(const TriangleMesh* model) const {
  const Impl& run = *impl_;
  std::vector<std::uint32_t> rows;  // per surface vertex: its index in the mesh, ~0u for none
  TriangleMesh mesh = run.body.surface.two_sided(&rows);
  if (model) transfer_attributes(*model, mesh);
  mesh.attributes.normal.clear();
  if (run.collisions->on()) {
    mesh.vertices = run.collisions->living_positions(run.body);
    return mesh;
  }
  const std::vector<Vec3>& u = run.state.motion.displacement;
  const auto gradient = run.solid.gradients(u);
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
