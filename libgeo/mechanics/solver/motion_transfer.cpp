// SolidDiscretisation::update_nodes() of solid_discretisation.h. Transfer of motion over a cut: to
// new and moved nodes, with the momenta of each component of the graph.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "geometry/nearest_rotation.h"
#include "geometry/principal_inertia.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/solver/debris.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {
namespace {

// Mass, momenta and inertia of a component, about the origin.
struct Momenta {
  double mass = 0;
  Vec3 moment = Vec3::Zero(), linear = Vec3::Zero(), angular = Vec3::Zero();  // moment: Σ m x
  Mat3 inertia = Mat3::Zero();
  void add(double m, const Vec3& x, const Vec3& v) {
    mass += m;
    moment += m * x;
    linear += m * v;
    angular += m * x.cross(v);
    inertia += m * (x.squaredNorm() * Mat3::Identity() - x * x.transpose());
  }
  friend Momenta operator+(const Momenta& a, const Momenta& b) {
    return {.mass = a.mass + b.mass,
            .moment = a.moment + b.moment,
            .linear = a.linear + b.linear,
            .angular = a.angular + b.angular,
            .inertia = a.inertia + b.inertia};
  }
};

// A velocity field.
struct RigidVelocity {
  Vec3 centre, velocity, spin;
  Vec3 at(const Vec3& x) const { return velocity + spin.cross(x - centre); }
};

// The rigid velocity that restores the momenta of a component: the linear one, and the angular one
// about its centre of mass. About a fixed point the angular momentum may change, as mass is
// redistributed: were that corrected, a component that only travels would begin to turn. A
// component on a line has no inertia about it and gets no spin about it.
// A component that took mass from another, or gave it, keeps its mean velocity and spin.
RigidVelocity correction(const Momenta& before, const Momenta& after) {
  constexpr double rounding = 1e-9;  // of the largest moment of inertia
  const double share = after.mass / before.mass;
  const Vec3 c = after.moment / after.mass, linear = share * before.linear - after.linear;
  const Vec3 angular = share * (before.angular - (before.moment / before.mass).cross(before.linear)) - after.angular +
                       c.cross(after.linear);
  const PrincipalInertia inertia(after.inertia - after.mass * (c.squaredNorm() * Mat3::Identity() - c * c.transpose()));
  const Vec3 spin = inertia.angular_velocity(angular, rounding * inertia.moments[2]);
  return {c, linear / after.mass, inertia.axes * spin};
}

// A node that has moved: where it was, and its velocity.
struct MovedNode {
  std::uint32_t node;
  Vec3 position, velocity;
};

// Displacement and velocity before a cut at a position in the material: those of a donor and of its
// neighbours, each extended by its gradient, averaged by their kernels. One node's gradient alone
// changes the strain energy of a bent body. Far from the donor, its motion alone counts.
std::pair<Vec3, Vec3> motion_at(const Vec3& x, std::size_t donor, const SolidDiscretisation& before,
                                const std::vector<double>& radius, const State& state) {
  const std::vector<Vec3>&u = state.displacement, &v = state.velocity;
  const auto extended = [&](std::size_t j) {
    const Vec3 offset = x - before.position[j];
    return std::pair<Vec3, Vec3>(u[j] + before.mls.displacement_gradient(j, u) * offset,
                                 v[j] + before.mls.gradient(j, v) * offset);
  };
  const auto weight = [&](std::size_t j) { return kernel((x - before.position[j]).norm(), radius[j]); };
  auto [displacement, velocity] = extended(donor);
  double sum = weight(donor);
  if (!(sum > 0)) return {displacement, velocity};
  displacement *= sum;
  velocity *= sum;
  for (const auto j : before.mls[donor].neighbors) {
    const double w = before.mls.quality(j) == MomentQuality::good ? weight(j) : 0;
    if (!(w > 0)) continue;
    const auto [own_displacement, own_velocity] = extended(j);
    sum += w;
    displacement += w * own_displacement;
    velocity += w * own_velocity;
  }
  return {displacement / sum, velocity / sum};
}

// The old node that a chain of donors ends at.
std::size_t old_donor(std::size_t node, std::size_t old_count, std::span<const NodeId> donors) {
  while (node >= old_count) node = donors[node - old_count].index();
  return node;
}

// Extends the motion to new nodes from the old nodes around them and moves that of moved nodes with
// them, by the gradients before the cut. Returns the nodes that moved, ascending.
std::vector<MovedNode> extend_motion(const SolidDiscretisation& before, const NodeSet& nodes, std::size_t old_count,
                                     std::span<const NodeId> donors, std::span<const NodeId> updated, State& state) {
  const std::size_t n = nodes.size();
  std::vector<std::pair<Vec3, Vec3>> motion(n - old_count);
  parallel_for(motion.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      motion[k] = motion_at(nodes.position[old_count + k], old_donor(old_count + k, old_count, donors), before,
                            nodes.radius, state);
  });
  for (std::size_t i = old_count; i < n; ++i) {
    state.displacement.push_back(motion[i - old_count].first);
    state.velocity.push_back(motion[i - old_count].second);
    const std::size_t donor = old_donor(i, old_count, donors);
    if (!state.acceleration.empty()) state.acceleration.push_back(Vec3(state.acceleration[donor]));
    if (!state.smooth.empty()) state.smooth.push_back(0);
    if (before.galerkin) continue;  // nodes are points
    if (!state.plastic.empty()) state.plastic.push_back(Mat3(state.plastic[donor]));
    if (!state.prestretch.empty()) state.prestretch.push_back(Mat3(state.prestretch[donor]));
  }
  std::vector<MovedNode> moved;
  for (const NodeId id : updated) {
    const std::size_t i = id.index();
    if (i >= old_count || before.position[i] == nodes.position[i]) continue;
    moved.push_back({id.value, before.position[i] + state.displacement[i], state.velocity[i]});
    state.displacement[i] +=
        before.mls.displacement_gradient(i, state.displacement) * (nodes.position[i] - before.position[i]);
  }
  std::sort(moved.begin(), moved.end(), [](const MovedNode& a, const MovedNode& b) { return a.node < b.node; });
  return moved;
}

// The rigid motion of a held box, and its velocity.
struct BoxMotion {
  Vec3 centre, translation;
  Mat3 rotation;  // about the centre
  RigidVelocity velocity;

  Vec3 displacement(const Vec3& x) const { return translation + (rotation - Mat3::Identity()) * (x - centre); }
};

// That of a component's nodes in a box, by Kabsch (1976), though they lie in a plane. Empty where
// they lie about on a line: they leave open how the material has turned about it, which Eq. 1
// knows.
std::optional<BoxMotion> motion_of_box(const SolidDiscretisation& before, std::span<const std::uint32_t> nodes,
                                       const State& state) {
  if (nodes.empty()) return {};
  const double share = 1.0 / double(nodes.size());
  Vec3 centre = Vec3::Zero();
  Vec3 translation = Vec3::Zero();
  Momenta momenta;
  for (const std::uint32_t i : nodes) {
    centre += share * before.position[i];
    translation += share * state.displacement[i];
    momenta.add(1, before.position[i] + state.displacement[i], state.velocity[i]);
  }
  Mat3 own = Mat3::Zero();
  Mat3 cross = Mat3::Zero();
  for (const std::uint32_t i : nodes) {
    const Vec3 arm = before.position[i] - centre;
    own += arm * arm.transpose();
    cross += (arm + state.displacement[i] - translation) * arm.transpose();
  }
  // Extent across the line over that along it, below which noise decides about the rotation.
  constexpr double flat = 0.1;
  const Vec3 extents = Eigen::SelfAdjointEigenSolver<Mat3>(own, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(extents[1] > flat * flat * extents[2])) return {};
  Momenta still = momenta;
  still.linear = still.angular = Vec3::Zero();
  BoxMotion motion{.centre = centre,
                   .translation = translation,
                   .rotation = Mat3::Identity(),
                   .velocity = correction(momenta, still)};
  const Vec3& first = state.displacement[nodes[0]];
  if (std::all_of(nodes.begin(), nodes.end(), [&](auto i) { return state.displacement[i] == first; }))
    motion.translation = first;  // to the bit
  else
    motion.rotation = nearest_rotation(cross).rotation;
  return motion;
}

// A node in a held box, and the displacement and velocity of the box there.
struct HeldNode {
  std::size_t node;
  Vec3 displacement, velocity;
};

// The nodes of a component in a held box.
std::vector<std::uint32_t> held_part(const SolidDiscretisation& before, std::uint32_t box, std::uint32_t component) {
  std::vector<std::uint32_t> nodes = before.held.nodes_in(box, before.position);
  std::erase_if(nodes, [&](std::uint32_t i) { return before.component[i] != component; });
  return nodes;
}

// The motions of new and moved nodes in held boxes: they move as the boxes do. Else held material
// would be strained between them and the nodes that it had, for as long as it is held. A component
// that hangs on one or two nodes may have turned about them, so each tells its own motion.
std::vector<HeldNode> motions_in_boxes(const SolidDiscretisation& before, const NodeSet& nodes,
                                       std::span<const NodeId> donors, std::span<const NodeId> updated,
                                       const State& state) {
  const std::size_t old_count = before.position.size();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::optional<BoxMotion>> parts;  // by box and component
  std::vector<HeldNode> motions;
  for (const NodeId id : updated) {
    const std::size_t i = id.index();
    if (i < old_count && before.position[i] == nodes.position[i]) continue;
    const Vec3& x = nodes.position[i];
    const std::optional<std::uint32_t> box = before.held.rigid_box_at(x);
    if (!box) continue;
    const std::uint32_t component = before.component[old_donor(i, old_count, donors)];
    const auto [known, is_new] = parts.try_emplace({*box, component});
    if (is_new) known->second = motion_of_box(before, held_part(before, *box, component), state);
    if (!known->second) continue;
    const BoxMotion& motion = *known->second;
    const Vec3 displacement = motion.displacement(x);
    motions.push_back({.node = i, .displacement = displacement, .velocity = motion.velocity.at(x + displacement)});
  }
  return motions;
}

// The rotation of each updated or new node before a cut, at its donor. Empty without motion.
std::vector<Mat3> rotations_before(const SolidDiscretisation& before, std::size_t old_count,
                                   std::span<const NodeId> donors, std::span<const NodeId> nodes, const State& state) {
  if (state.displacement.empty()) return {};
  std::vector<std::uint32_t> old;
  for (const NodeId i : nodes) old.push_back(static_cast<std::uint32_t>(old_donor(i.index(), old_count, donors)));
  return rotations_at(before.mls, old, state.displacement);
}

// Sets the rotations of nodes whose neighbours no longer determine them.
void keep_rotations(const SolidDiscretisation& solid, std::span<const NodeId> updated, const std::vector<Mat3>& before,
                    State& state) {
  const bool any = std::any_of(updated.begin(), updated.end(),
                               [&](NodeId i) { return solid.mls.quality(i.index()) != MomentQuality::good; });
  if (before.empty() || (!any && state.rotation.empty())) return;
  state.rotation.resize(solid.size(), Mat3::Identity());
  for (std::size_t k = 0; k < updated.size(); ++k)
    state.rotation[updated[k].index()] =
        solid.mls.quality(updated[k].index()) == MomentQuality::good ? Mat3(Mat3::Identity()) : before[k];
}

// Gives each component with new or moved mass the momenta back that it had before. `mass`: per node
// before the cut. A new node in another component than its donor had the donor's motion.
void restore_momenta(const SolidDiscretisation& solid, const std::vector<double>& mass, std::span<const NodeId> donors,
                     const std::vector<MovedNode>& moved, State& state) {
  const std::vector<std::uint32_t>& component = solid.component;
  const std::size_t old_count = mass.size();
  const auto at = [&](std::size_t i) -> Vec3 { return solid.position[i] + state.displacement[i]; };
  std::vector<char> is_stale(solid.components, 0);
  std::vector<Momenta> change(solid.components);  // before less after
  const auto add = [&](std::uint32_t c, double m, const Vec3& x, const Vec3& v) {
    is_stale[c] = 1;
    change[c].add(m, x, v);
  };
  auto next = moved.begin();
  for (std::size_t i = 0; i < old_count; ++i) {
    const bool moves = next != moved.end() && next->node == i;
    if (!moves && solid.mass[i] == mass[i]) continue;
    add(component[i], mass[i], moves ? next->position : at(i), moves ? next->velocity : state.velocity[i]);
    add(component[i], -solid.mass[i], at(i), state.velocity[i]);
    if (moves) ++next;
  }
  for (std::size_t i = old_count; i < solid.size(); ++i) {
    add(component[i], -solid.mass[i], at(i), state.velocity[i]);
    const std::size_t d = old_donor(i, old_count, donors);
    if (component[d] == component[i]) continue;
    add(component[i], solid.mass[i], at(d), state.velocity[d]);
    add(component[d], -solid.mass[i], at(d), state.velocity[d]);
  }
  std::vector<Momenta> after(solid.components);
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (is_stale[component[i]]) after[component[i]].add(solid.mass[i], at(i), state.velocity[i]);
  std::vector<RigidVelocity> corrections(solid.components);
  for (std::uint32_t c = 0; c < solid.components; ++c)
    if (is_stale[c]) corrections[c] = correction(after[c] + change[c], after[c]);
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (const auto c = component[i]; is_stale[c]) state.velocity[i] += corrections[c].at(at(i));
}

}  // namespace

// Without a component coming apart, new nodes belong to the component of any older node that they
// see. The lowest node of each component decides its number, so all numbers stay.
void SolidDiscretisation::number_new_components(const VisibilityGraph& graph, std::size_t first_new) {
  for (std::size_t i = first_new; i < graph.node_count(); ++i) {
    std::uint32_t own = ~0u;
    for (const NodeId j : graph.edges(NodeId(i)))
      if (j.index() < component.size()) own = component[j.index()];
    if (own == ~0u) {  // it sees newer nodes only
      components = graph.components(component);
      return;
    }
    component.push_back(own);
  }
}

void SolidDiscretisation::update_nodes(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new,
                                       std::span<const NodeId> donors, std::span<const NodeId> updated, State& state,
                                       bool parted) {
  const std::size_t n = nodes.size(), old_count = first_new.index();
  std::vector<MovedNode> moved;
  const std::vector<double> mass_before = mass;
  const std::vector<Mat3> rotations = rotations_before(*this, old_count, donors, updated, state);
  if (!state.displacement.empty()) {
    const std::vector<HeldNode> held_nodes = motions_in_boxes(*this, nodes, donors, updated, state);
    moved = extend_motion(*this, nodes, old_count, donors, updated, state);
    for (const HeldNode& m : held_nodes) {
      state.displacement[m.node] = m.displacement;
      state.velocity[m.node] = m.velocity;
    }
  }
  volume = nodes.volume;
  spacing = nodes.spacing;
  position = nodes.position;
  mass.resize(n);
  for (std::size_t i = old_count; i < n; ++i) materials.add_node(donors[i - old_count].index());
  for (std::size_t i = 0; i < n; ++i) mass[i] = materials.of(i).density * volume[i];
  parallel_invoke([&] { mls.update(nodes, graph, updated); },
                  [&] {
                    if (parted || component.size() != old_count)
                      components = graph.components(component);
                    else
                      number_new_components(graph, old_count);
                  });
  // Forces on nodes whose neighbourhood has changed do not go on from those of the last step.
  for (const NodeId i : updated)
    if (!state.smooth.empty()) state.smooth[i.index()] = 0;
  keep_rotations(*this, updated, rotations, state);
  mls.set_rotations(state.rotation);
  if (!state.displacement.empty()) restore_momenta(*this, mass_before, donors, moved, state);
}

}  // namespace geo
