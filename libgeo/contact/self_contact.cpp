// One step: penalty on the nodes, opening of sheets, bounded motion of the surface to the targets.
// First guess of its end: target + 0.9 · tracking error at the step's beginning
// (docs/decisions/076).
#include "contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/elementary.h"
#include "contact/motion/bounded_motion.h"
#include "contact/response/impulse_response.h"
#include "contact/response/penalty_assembly.h"
#include "contact/surface/open_sheets.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"

namespace geo {
namespace {

constexpr std::size_t vertices_per_task = 1024;
// Share of an existing separation deficit that a whole step makes good. Making good all of it at
// once would throw the walls apart.
constexpr double deficit_share = 0.5;

// First guess of where vertices can go: what kept them off their targets when the step began is
// likely to do so at its end.
std::vector<Vec3> likely_positions(const std::vector<Vec3>& targets, const std::vector<Vec3>& tracking_error,
                                   std::span<const std::uint32_t> representative, double edge) {
  constexpr double persistence = 0.9;  // per step: without an obstacle the surface approaches its targets
  constexpr double negligible = 1e-3;  // of an edge; affects the first guess only
  std::vector<Vec3> result = targets;
  parallel_for(std::min(result.size(), tracking_error.size()), vertices_per_task,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t v = begin; v < end; ++v)
                   if (const Vec3& error = tracking_error[representative[v]]; error.norm() > negligible * edge)
                     result[v] += persistence * error;
               });
  return result;
}

// Weights that are updated, so that members after them can use them.
SurfaceWeights weights_of(const Body& body, const Solid& solid) {
  SurfaceWeights weights;
  weights.rebuild(body, solid);
  return weights;
}

MovingSurface initial_surface(const Body& body, const Solid& solid, const SurfaceWeights& weights,
                              std::vector<Vec3> positions) {
  ContactSurface topology = contact_surface(body.surface);
  if (positions.size() != topology.site.size())
    positions = surface_targets(weights, std::vector<Vec3>(solid.size(), Vec3::Zero()));
  return {std::move(topology), std::move(positions)};
}

}  // namespace

ContactStats& ContactStats::operator+=(const ContactStats& o) {
  planes += o.planes;
  touching += o.touching;
  in_zones += o.in_zones;
  opened += o.opened;
  held += o.held;
  tracking_error = std::max(tracking_error, o.tracking_error);
  seconds += o.seconds;
  return *this;
}

SelfContact::SelfContact(const Body& body, const Solid& solid, const ContactOptions& options,
                         std::vector<Vec3> positions)
    : options_(options),
      weights_(weights_of(body, solid)),
      surface_(initial_surface(body, solid, weights_, std::move(positions))) {}

// Vertices of which no copy that moves with them is carried by a node that is awake. `asleep`: per
// node, or empty.
std::vector<std::uint8_t> SelfContact::still_vertices(const std::vector<std::uint8_t>& asleep) {
  if (asleep.empty()) return {};
  const std::vector<std::uint32_t>& node = weights_.heaviest();
  const Coincidence& coincidence = surface_.coincidence();
  std::vector<std::uint8_t> still(node.size(), 0);
  for (std::size_t v = 0; v < still.size(); ++v) {
    const auto group = coincidence.coincident[coincidence.representative[v]];
    still[v] = std::all_of(group.begin(), group.end(), [&](auto w) { return node[w] != ~0u && asleep[node[w]]; });
  }
  return still;
}

ContactStep SelfContact::begin_step(const Body& body, const Solid& solid, const State& state, double dt,
                                    const Environment& environment, const ContactPace& pace) {
  update_weights(body, solid, state.displacement);
  const FreeMotion free = free_motion(body, solid, state, dt, environment);
  const std::vector<Vec3>& targets = targets_at(state.displacement);
  const std::vector<Vec3> free_targets = surface_targets(weights_, free.displacement),
                          mean_targets = surface_.coincidence().averaged(targets);
  ContactStep step;
  step.revision = revision_;
  step.tracking_error.resize(mean_targets.size());
  parallel_for(mean_targets.size(), vertices_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) step.tracking_error[v] = positions()[v] - mean_targets[v];
  });
  // Slip regularisation ε = 0.01 g dt² + 1e-9 edge: slip below a hundredth of the distance g dt²
  // of one step counts as rest. The second term keeps ε > 0 without gravity.
  const SelfContactPenaltyOptions penalty_options{options_.friction,
                                                  1e-2 * dt * dt * environment.gravity.norm() + 1e-9 * surface().edge};
  step.penalty = spare_penalty_ ? std::move(spare_penalty_) : std::make_unique<SelfContactPenalty>(penalty_options);
  step.penalty->restart(penalty_options);
  step.still = still_vertices(environment.asleep);
  near_.select(moving_triangles(surface().triangles, step.still));
  assemble_penalty(
      {.body = body,
       .solid = solid,
       .weights = weights_,
       .displacement = state.displacement,
       .free = free,
       .targets = targets,
       .mean_targets = mean_targets,
       .free_targets = free_targets,
       .dt = dt,
       .stopping = pace.stopping > 0 ? pace.stopping : dt,
       .made_good = 1 - exponential(logarithm(1 - deficit_share) * (pace.whole_step > 0 ? dt / pace.whole_step : 1)),
       .gap = gap()},
      surface_, near_, *step.penalty);
  return step;
}

ContactStats SelfContact::finish_step(ContactStep step, const Solid& solid, const std::vector<Vec3>& displacement) {
  if (!step.penalty) throw std::logic_error("the contact step was finished before");
  if (step.revision != revision_) throw std::logic_error("the surface has changed since the contact step began");
  Stopwatch clock;
  const std::size_t touching = step.penalty->pressing();
  take_rotations(solid, displacement);
  ContactStats stats = move_surface(displacement, &step);
  stats.touching = touching;
  spare_penalty_ = std::move(step.penalty);
  stats.seconds = clock.lap();
  return stats;
}

ContactStats SelfContact::finish_step_with_impulses(const Body& body, const Solid& solid,
                                                    const std::vector<Vec3>& before, double dt,
                                                    const std::vector<std::uint8_t>& fixed, State& state) {
  Stopwatch clock;
  update_weights(body, solid, state.displacement);
  const std::size_t touching = resolve_with_impulses(
      {.solid = solid, .weights = weights_, .before = before, .dt = dt, .fixed = fixed},
      {.gap = gap(), .friction = options_.friction, .recovery = options_.recovery, .rounds = options_.rounds}, surface_,
      near_, state);
  ContactStats stats = move_surface(state.displacement, nullptr);
  stats.touching = touching;
  stats.seconds = clock.lap();
  return stats;
}

void SelfContact::take_rotations(const Solid& solid, const std::vector<Vec3>& u) {
  if (weights_.set_rotations(solid, u)) targets_ = {};
}

// Opens sheets, then moves all vertices towards their targets at displacements u. `step`: null
// where there was none.
ContactStats SelfContact::move_surface(const std::vector<Vec3>& u, const ContactStep* step) {
  ContactStats stats;
  std::vector<Vec3> targets = targets_at(u);
  for (std::size_t v = 0; step && v < step->still.size(); ++v)
    if (step->still[v]) targets[v] = positions()[v];
  std::vector<Vec3> opened = positions();
  stats.opened = open_sheets(surface(), surface_.fans(), surface_.coincidence(), targets, gap(),
                             options_.opening * surface().edge, opened);
  if (stats.opened > 0) surface_.move_to(std::move(opened));
  const Coincidence& coincidence = surface_.coincidence();
  std::vector<Vec3> goal = coincidence.averaged(targets), guess;
  if (step) guess = likely_positions(goal, step->tracking_error, coincidence.representative, surface().edge);
  // A mean of equal positions may differ from them by rounding.
  for (std::size_t v = 0; step && v < step->still.size(); ++v)
    if (step->still[v]) goal[v] = guess[v] = positions()[v];
  BoundedMotionStats bounded;
  surface_.move_to(move_without_crossing({.triangles = surface().triangles,
                                          .representative = coincidence.representative,
                                          .from = positions(),
                                          .to = goal,
                                          .gap = gap(),
                                          .reach = 2 * gap(),
                                          .guess = step ? &guess : nullptr,
                                          .still = step ? step->still : std::span<const std::uint8_t>()},
                                         true, &bounded, &near_, &surface_.fans()));
  ++revision_;
  near_.invalidate();
  stats.planes = bounded.planes;
  stats.in_zones = bounded.in_zones;
  stats.held = bounded.held;
  for (std::size_t v = 0; v < targets.size(); ++v)
    if (weights_.alive(v)) stats.tracking_error = std::max(stats.tracking_error, (positions()[v] - targets[v]).norm());
  return stats;
}

EmbeddingPlan SelfContact::plan_embedding(const Body& body, const Solid& solid, const State& state,
                                          const Complex& grown, const CrackDelta& crack) const {
  return {embed_new_surface({.body = body,
                             .solid = solid,
                             .state = state,
                             .before = surface(),
                             .positions = positions(),
                             .after = grown,
                             .crack = crack,
                             .gap = gap()}),
          revision_};
}

void SelfContact::commit(EmbeddingPlan plan, const Body& body, const BodyDelta& delta) {
  if (plan.revision != revision_) throw std::logic_error("the surface has changed since the embedding was planned");
  surface_.replace(std::move(plan.embedding.surface), std::move(plan.embedding.positions));
  ++revision_;
  near_.reset();
  weights_.mark_changed(body, delta);
}

void SelfContact::update_weights(const Body& body, const Solid& solid, const std::vector<Vec3>& u) {
  if (weights_.has_changes()) targets_.invalidate(weights_.update(body, solid));
  take_rotations(solid, u);
}

}  // namespace geo
