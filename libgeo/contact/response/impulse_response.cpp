// Rounds: constraints of the motion to the targets, impulses on node velocities, u += dt Δv. A last
// pass recovers penetration by displacements alone: velocities do not change.
#include "contact/response/impulse_response.h"

#include "contact/response/contact_constraints.h"
#include "contact/response/impulses.h"
#include "contact/surface/surface_targets.h"

namespace geo {
namespace {

class ImpulseResponse {
 public:
  ImpulseResponse(const StepWithoutContact& step, double gap, MovingSurface& surface, BroadPhase& near)
      : step_(step),
        gap_(gap),
        surface_(surface),
        near_(near),
        normals_(normals_across_sheets(
            surface.topology(), surface.coincidence().representative,
            vertex_normals(surface.topology(), surface.fans(), surface.coincidence().coincident, surface.positions()),
            surface.positions())),
        alone_(CoincidentVertices::all_distinct(surface.positions().size())) {
    for (std::size_t i = 0; i < step.solid.size(); ++i)
      inverse_mass_.push_back(step.fixed.empty() || !step.fixed[i] ? 1 / step.solid.mass(NodeId(i)) : 0);
  }

  // Finds contacts of the motion to the targets at displacements u, and changes `velocity`, per
  // node, so that they satisfy their constraints. Returns the number of contacts.
  std::size_t respond(const std::vector<Vec3>& u, const ConstraintOptions& constraint, double friction,
                      std::vector<Vec3>& velocity) {
    const auto& [representative, coincident] = surface_.coincidence();
    const std::vector<Vec3> to = surface_targets(step_.weights, u), goal = surface_.coincidence().averaged(to);
    const SurfaceMotion motion{.triangles = surface_.topology().triangles,
                               .representative = representative,
                               .from = surface_.positions(),
                               .to = goal,
                               .gap = gap_,
                               .reach = 2 * gap_};
    if (candidates_.empty()) candidates_ = find_contact_candidates(motion, near_);
    const auto near = deepest_constraints(contact_constraints(candidates_, motion, constraint), step_.weights,
                                          constraints_per_node_pair);
    std::vector<ContactConstraint> all_sides;
    // Tolerance of 0.01 gap: coincident sides whose targets overlap by less get no constraint.
    add_sheet_constraints(coincident, to, normals_, 0.01 * gap_, constraint, all_sides);
    const auto sides = deepest_constraints(all_sides, step_.weights, constraints_per_node_pair);
    ImpulseOptions options;
    options.friction = friction;
    const std::size_t count =
        apply_impulses(step_.weights, near, coincident, inverse_mass_, options, velocity).touching;
    return count + apply_impulses(step_.weights, sides, alone_, inverse_mass_, options, velocity).touching;
  }

 private:
  const StepWithoutContact& step_;
  double gap_;  // model units
  MovingSurface& surface_;
  BroadPhase& near_;
  std::vector<Vec3> normals_;  // per surface vertex, of its sheet
  CoincidentVertices alone_;   // no vertices coincide: the sides of a sheet move apart
  std::vector<double> inverse_mass_;
  std::vector<ContactCandidate> candidates_;  // of the first round
};

}  // namespace

std::size_t resolve_with_impulses(const StepWithoutContact& step, const ImpulseResponseOptions& options,
                                  MovingSurface& surface, BroadPhase& near, State& state) {
  const std::size_t n = step.solid.size();
  const double dt = step.dt;
  std::vector<Vec3> velocity(n), u = state.displacement;
  for (std::size_t i = 0; i < n; ++i) velocity[i] = (state.displacement[i] - step.before[i]) / dt;
  const std::vector<Vec3> free = velocity;
  ImpulseResponse response(step, options.gap, surface, near);
  std::size_t touching = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const std::size_t count = response.respond(u, {dt}, options.friction, velocity);
    touching += count;
    if (count == 0) break;
    for (std::size_t i = 0; i < n; ++i) u[i] = state.displacement[i] + dt * (velocity[i] - free[i]);
  }
  if (touching == 0) return 0;
  std::vector<Vec3> recovery(n, Vec3::Zero());
  response.respond(u, {dt, options.recovery}, 0, recovery);
  for (std::size_t i = 0; i < n; ++i) {
    state.displacement[i] += dt * (velocity[i] - free[i] + recovery[i]);
    state.velocity[i] += velocity[i] - free[i];
  }
  return touching;
}

}  // namespace geo
