// Candidates of the free motion become contacts with depth = separation − n · (a − b), at most
// constraints_per_node_pair for two nodes. Stiffness: 2 E / (ρ h²) + 1 / t² per effective mass.
#include "contact/response/penalty_assembly.h"

#include <algorithm>

#include "contact/response/contact_constraints.h"
#include "contact/response/impulses.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Separation that the penalty keeps beyond the gap, in mean edges. The penetration that carries a
// load uses it up, and the surface can still follow its targets.
constexpr double kept_separation = 0.02;
// Distance below which pairs are contact candidates, in mean edges: more than kept_separation,
// because the prediction leaves out the forces of the step.
constexpr double candidate_distance = 0.05;
// Stiffness over that of the material between two nodes, E / (ρ h²) per mass. A contact is deep by
// about half of what the material between two nodes is compressed.
constexpr double relative_stiffness = 2;

class PenaltyAssembly {
 public:
  PenaltyAssembly(const PenaltyInput& input, MovingSurface& surface, SelfContactPenalty& penalty)
      : in_(input), surface_(surface), edge_(surface.topology().edge), penalty_(penalty) {
    // 1 / t² lets a contact stop in this time what comes at it.
    const double h = input.free.mean_spacing;
    for (const Material& m : input.solid.materials().all())
      stiffness_.push_back(relative_stiffness * m.young / (m.density * h * h) + 1 / (input.stopping * input.stopping));
  }

  // Contacts between points of different triangles.
  void add_near_pairs(BroadPhase& near) {
    const auto& [representative, coincident] = surface_.coincidence();
    const std::vector<Vec3> to = surface_.coincidence().averaged(in_.free_targets);
    const double reach = candidate_distance * edge_;
    const SurfaceMotion motion{.triangles = surface_.topology().triangles,
                               .representative = representative,
                               .from = surface_.positions(),
                               .to = to,
                               .gap = in_.gap,
                               .reach = reach};
    const auto candidates =
        find_contact_candidates(motion, near, {in_.weights.heaviest(), 2 * constraints_per_node_pair});
    add(deepest_constraints(contact_constraints(candidates, motion, {in_.dt, 0, reach}), in_.weights,
                            constraints_per_node_pair),
        coincident, in_.mean_targets, in_.gap + kept_separation * edge_);
  }

  // Contacts between the two sides of a closed sheet: coincident vertices.
  void add_sheet_sides() {
    const auto& [representative, coincident] = surface_.coincidence();
    std::vector<ContactConstraint> sides;
    const ContactSurface& surface = surface_.topology();
    const std::vector<Vec3>& positions = surface_.positions();
    const auto normals = normals_across_sheets(
        surface, representative, vertex_normals(surface, surface_.fans(), coincident, positions), positions);
    add_sheet_constraints(coincident, in_.free_targets, normals, -candidate_distance * edge_, {in_.dt}, sides);
    add(deepest_constraints(sides, in_.weights, constraints_per_node_pair),
        CoincidentVertices::all_distinct(coincident.size()), in_.targets, 0);
  }

 private:
  // `at`: targets of vertices at the beginning; `separation`: to be kept, 0 between sides of a
  // sheet.
  void add(const std::vector<ContactConstraint>& constraints, const CoincidentVertices& stands_for,
           const std::vector<Vec3>& at, double separation) {
    const std::vector<RelativeStencil> stencils =
        relative_stencils(in_.weights, constraints, stands_for, in_.free.inverse_mass);
    std::vector<SelfContactPenalty::Addition> all(stencils.size());
    parallel_for(stencils.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ContactConstraint& c = constraints[i];
        const double limit = separation > 0 ? std::min(separation, separation_at_rest(c)) : 0;
        const double deficit = limit - c.normal.dot(position_of(c.a, at) - position_of(c.b, at));
        // Without the nodes that both points share: these would make it too stiff near a crack
        // front.
        const bool moves = stencils[i].inverse_mass_a + stencils[i].inverse_mass_b > 0;
        all[i] = {.stencil = moves ? &stencils[i] : nullptr,
                  .normal = c.normal,
                  .depth = deficit > 0 ? in_.made_good * deficit : deficit,
                  .stiffness = moves ? stiffness(c, stencils[i]) : 0,
                  .start = weighted_sum(stencils[i].entries, in_.displacement)};
      }
    });
    std::erase_if(all, [](const auto& addition) { return !addition.stencil; });
    penalty_.add(all);
  }

  // Distance of the two points along the normal in the undeformed body: points that were modelled
  // nearer than the separation to be kept stay so.
  double separation_at_rest(const ContactConstraint& c) const {
    const auto rest = [&](const SurfacePoint& p) {
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < p.size; ++k)
        sum += p.weight[k] * in_.body.surface.point(VertexId(surface_.topology().site[p.vertex[k]]));
      return sum;
    };
    const std::vector<Vec3>& x = surface_.positions();
    return (rest(c.a) - rest(c.b)).norm() * c.normal.dot((position_of(c.a, x) - position_of(c.b, x)).normalized());
  }

  // N/m: springs of the two points' materials in series.
  double stiffness(const ContactConstraint& c, const RelativeStencil& stencil) const {
    const double a = stiffness_at(c.a), b = stiffness_at(c.b);
    return a == b ? a / (stencil.inverse_mass_a + stencil.inverse_mass_b)
                  : 1 / (stencil.inverse_mass_a / a + stencil.inverse_mass_b / b);
  }
  double stiffness_at(const SurfacePoint& p) const {
    const auto node = in_.weights.heaviest()[p.vertex[0]];
    return stiffness_[node == ~0u ? 0 : in_.solid.materials().index(node)];
  }

  const PenaltyInput& in_;
  MovingSurface& surface_;
  double edge_;  // mean edge of the surface, model units
  SelfContactPenalty& penalty_;
  std::vector<double> stiffness_;  // per material, per effective mass, 1/s²
};

}  // namespace

FreeMotion free_motion(const Body& body, const Solid& solid, const State& state, double dt,
                       const Environment& environment) {
  const std::vector<std::uint8_t>& fixed = environment.fixed;
  const std::size_t n = solid.size();
  FreeMotion free{std::vector<double>(n), state.displacement, 0};
  for (std::size_t i = 0; i < n; ++i) {
    free.inverse_mass[i] = 1 / solid.mass(NodeId(i));
    free.mean_spacing += body.nodes.spacing[i] / double(n);
    if (fixed.empty() || !fixed[i]) free.displacement[i] += dt * state.velocity[i] + dt * dt * environment.gravity;
  }
  return free;
}

void assemble_penalty(const PenaltyInput& input, MovingSurface& surface, BroadPhase& near,
                      SelfContactPenalty& penalty) {
  PenaltyAssembly assembly(input, surface, penalty);
  assembly.add_near_pairs(near);
  assembly.add_sheet_sides();
}

}  // namespace geo
