// All nodes of a component have the same time of rest, that of the one with the least: new nodes
// and nodes at a cut have none. That of a cluster is the least of its components.
#include "simulation/sleep.h"

#include <algorithm>
#include <limits>

#include "base/union_find.h"
#include "geometry/aabb_tree.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {
namespace {

// A component rests while no node leaves a ball of this radius, in spacings (docs/decisions/110).
constexpr double resting = 0.05;

// Least time of rest of each component, s.
std::vector<double> times_of_rest(const SolidDiscretisation& solid, const RestState& rest) {
  std::vector<double> least(solid.components, std::numeric_limits<double>::max());
  for (std::size_t i = 0; i < rest.time.size(); ++i) {
    double& own = least[solid.component[i]];
    own = std::min(own, rest.time[i]);
  }
  return least;
}

// The boxes of the components: around each node a spacing, which reaches beyond the surface that it
// carries, and its way in a step.
std::vector<Box3> boxes_of(const SolidDiscretisation& solid, const State& motion, double dt, const Vec3& gravity) {
  std::vector<Box3> boxes(solid.components);
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const Vec3 at = solid.position[i] + motion.displacement[i];
    const double way = dt * motion.velocity[i].norm() + dt * dt * gravity.norm();
    Box3 ball;
    ball.add(at);
    boxes[solid.component[i]].add(ball.grown(solid.spacing[i] + way));
  }
  return boxes;
}

// Whether something carries a component: its mean acceleration is small beside gravity, and its
// mean velocity beside what a fall gains in the time of rest. A body that flies has
// either, even where it turns, or falls as fast as its damping lets it.
std::vector<std::uint8_t> is_carried(const SolidDiscretisation& solid, const State& motion, double fall,
                                     const Vec3& gravity) {
  constexpr double negligible_acceleration = 0.1, negligible_velocity = 0.01;  // of gravity, of a fall
  std::vector<double> mass(solid.components, 0);
  std::vector<Vec3> force(solid.components, Vec3::Zero()), momentum = force;
  for (std::size_t i = 0; i < motion.acceleration.size(); ++i) {
    mass[solid.component[i]] += solid.mass[i];
    force[solid.component[i]] += solid.mass[i] * motion.acceleration[i];
    momentum[solid.component[i]] += solid.mass[i] * motion.velocity[i];
  }
  std::vector<std::uint8_t> carried(solid.components, 0);
  for (std::size_t c = 0; c < carried.size(); ++c)
    carried[c] = mass[c] > 0 && force[c].norm() <= negligible_acceleration * mass[c] * gravity.norm() &&
                 momentum[c].norm() <= negligible_velocity * mass[c] * fall * gravity.norm();
  return carried;
}

}  // namespace

// Material that flows is never at rest.
bool Sleep::on() const {
  const auto flows = [](const Material& m) { return m.viscosity > 0 || m.yield > 0; };
  return scene_.sleep > 0 && scene_.implicit && !scene_.fracture.on && state_.glued.bonds.empty() &&
         scene_.loads.empty() && scene_.supports.empty() && !flows(scene_.material) &&
         std::none_of(scene_.bodies.begin(), scene_.bodies.end(),
                      [&](const SceneBody& body) { return body.material && flows(*body.material); });
}

void Sleep::begin_step(const Solid& solid, const std::vector<Vec3>& before, double dt, Environment& environment) {
  RestState& rest = state_.rest;
  const State& motion = state_.motion;
  for (std::size_t i = rest.anchor.size(); i < solid.size(); ++i) rest.anchor.push_back(motion.displacement[i]);
  rest.time.resize(solid.size(), 0);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (motion.displacement[i] != before[i]) rest.time[i] = 0;
  clamped_ = environment.fixed;
  dt_ = dt;
  mark_sleepers(solid, environment);
  for (const Potential* potential : environment.contact) wake(solid, *potential, environment);
}

void Sleep::wake(const Solid& solid, const Potential& potential, Environment& environment) {
  bool any = false;
  for (std::size_t k = 0; k < potential.size(); ++k)
    for (const NodeWeight& e : potential.stencil(k)) {
      state_.rest.time[e.node] = 0;
      any = true;
    }
  if (any) mark_sleepers(solid, environment);
}

// A component that was awake beside others counts anew with them.
void Sleep::mark_sleepers(const Solid& whole, Environment& environment) {
  const SolidDiscretisation& solid = SolidDiscretisation::of(whole);
  std::vector<double> time = times_of_rest(solid, state_.rest);
  environment.asleep.clear();
  environment.fixed = clamped_;
  all_ = false;
  if (std::none_of(time.begin(), time.end(), [&](double t) { return t >= scene_.sleep; })) return;
  UnionFind cluster(solid.components);
  for (const auto& [a, b] : overlapping_pairs(boxes_of(solid, state_.motion, dt_, environment.gravity)))
    cluster.unite(a, b);
  const std::vector<std::uint8_t> carried = is_carried(solid, state_.motion, scene_.sleep, environment.gravity);
  std::vector<double> least(time.size(), std::numeric_limits<double>::max());
  std::vector<std::uint8_t> sleeps(time.size(), 1);  // of clusters
  for (std::uint32_t c = 0; c < time.size(); ++c) {
    const auto own = cluster.find(c);
    least[own] = std::min(least[own], time[c]);
    sleeps[own] &= carried[c];
  }
  for (std::uint32_t c = 0; c < time.size(); ++c) {
    time[c] = least[cluster.find(c)];
    sleeps[c] = sleeps[cluster.find(c)] && time[c] >= scene_.sleep;
  }
  for (std::size_t i = 0; i < solid.size(); ++i) state_.rest.time[i] = time[solid.component[i]];
  if (std::find(sleeps.begin(), sleeps.end(), 1) == sleeps.end()) return;
  environment.asleep.assign(solid.size(), 0);
  State& motion = state_.motion;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    if (!sleeps[solid.component[i]]) continue;
    environment.asleep[i] = environment.fixed[i] = 1;
    motion.velocity[i].setZero();
    if (!motion.acceleration.empty()) motion.acceleration[i].setZero();
  }
  all_ = std::find(environment.asleep.begin(), environment.asleep.end(), 0) == environment.asleep.end();
}

void Sleep::end_step(const Solid& whole, double dt) {
  const SolidDiscretisation& solid = SolidDiscretisation::of(whole);
  State& motion = state_.motion;
  RestState& rest = state_.rest;
  std::vector<double> time = times_of_rest(solid, rest);
  std::vector<std::uint8_t> leaves(time.size(), 0);
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const double radius = resting * solid.spacing[i];
    if ((motion.displacement[i] - rest.anchor[i]).squaredNorm() > radius * radius) leaves[solid.component[i]] = 1;
  }
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const auto c = solid.component[i];
    rest.time[i] = leaves[c] ? 0 : std::min(time[c] + dt, scene_.sleep);
    if (leaves[c]) rest.anchor[i] = motion.displacement[i];
  }
}

void Sleep::wake(std::span<const NodeId> nodes) {
  for (const NodeId i : nodes)
    if (i.index() < state_.rest.time.size()) state_.rest.time[i.index()] = 0;
}

}  // namespace geo
