// Node i adds ½ m/τ² |u − ũ|² − f · (u − u₀) to elasticity and contact.
#include "mechanics/solver/incremental_potential.h"

#include "mechanics/solver/fixed_nodes.h"

namespace geo {

Bossak bossak_step(const StepProblem& problem, std::size_t node) {
  const State& start = problem.start;
  return {.dt = problem.dt,
          .drag = problem.solid.materials.of(node).damping,
          .displacement = start.displacement[node],
          .velocity = start.velocity[node],
          .acceleration = start.acceleration[node]};
}

// Contact joins components of the graph; the mode penalty of mueller04 is evaluated as a whole and
// joins all.
std::vector<std::pair<std::uint32_t, std::uint32_t>> IncrementalPotential::coupled_components() const {
  auto pairs = contact_.coupled_components(problem_.solid.component);
  if (problem_.solid.penalty)
    for (std::uint32_t c = 1; c < problem_.solid.components; ++c) pairs.emplace_back(c - 1, c);
  return pairs;
}

IncrementalPotential::IncrementalPotential(const StepProblem& problem)
    : problem_(problem),
      contact_(problem.environment.contact, problem.start.displacement, problem.environment.asleep),
      islands_(problem.solid.points, problem.solid.component, problem.solid.components, coupled_components()),
      elastic_(problem),
      bossak_(smooth_islands()),
      target_(problem.solid.size()),
      load_(problem.solid.size()),
      inertia_(problem.solid.size()) {
  const SolidDiscretisation& solid = problem.solid;
  const State& start = problem.start;
  const Environment& env = problem.environment;
  const double dt = problem.dt;
  std::vector<double> damping;  // per material: factor of velocities
  for (const Material& m : solid.materials.all()) damping.push_back(1 / (1 + m.damping * dt));
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const auto island = islands_.of(i);
    inertia_[i] = solid.mass[i] / squared_time(island);
    target_[i] = start.displacement[i];
    load_[i] = solid.mass[i] * env.gravity;
    if (!env.load.empty()) load_[i] += env.load[i];
    if (is_fixed(env, i)) continue;
    if (bossak_[island])
      target_[i] = bossak_step(problem, i).target();
    else
      target_[i] += dt * damping[solid.materials.index(i)] * start.velocity[i];
  }
}

// Fixed nodes have no inertia.
std::vector<char> IncrementalPotential::smooth_islands() const {
  std::vector<char> smooth(islands_.count(), !problem_.smooth.empty());
  for (std::size_t i = 0; i < problem_.smooth.size(); ++i)
    if (!problem_.smooth[i] && !is_fixed(problem_.environment, i)) smooth[islands_.of(i)] = 0;
  return smooth;
}

double IncrementalPotential::nodal_energy(std::size_t node, const Vec3& u) const {
  const SolidDiscretisation& solid = problem_.solid;
  const double squared = squared_time(islands_.of(node));
  const Vec3& u0 = problem_.start.displacement[node];
  return 0.5 * solid.mass[node] / squared * (u - target_[node]).squaredNorm() - load_[node].dot(u - u0);
}

void IncrementalPotential::evaluate(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& value,
                                    ElasticResponse* response) {
  if (active.none()) return;
  std::vector<double> elastic(islands_.count(), 0), contact(islands_.count(), 0);
  elastic_.evaluate(active, u, elastic, response);
  active.sum(value, 0.0, [&](std::size_t i) { return nodal_energy(i, u[i]); });
  contact_.add_energy(u, islands_.of_nodes(), active.mask(), contact);
  for (std::size_t p = 0; p < islands_.count(); ++p)
    if (active[p]) value[p] += elastic[p] + contact[p];
}

double IncrementalPotential::elastic_energy(const ActiveIslands& active, const std::vector<Vec3>& u) {
  std::vector<double> energy(islands_.count(), 0);
  elastic_.evaluate(active, u, energy, nullptr);
  double sum = 0;
  for (std::size_t p = 0; p < energy.size(); ++p)
    if (active[p]) sum += energy[p];
  return sum;
}

void IncrementalPotential::force(const ActiveIslands& active, const std::vector<Vec3>& u,
                                 const ElasticResponse& response, std::vector<Vec3>& force) {
  const SolidDiscretisation& solid = problem_.solid;
  const Environment& env = problem_.environment;
  contact_.update_derivatives(islands_.of_nodes(), active.mask());
  active.each_node([&](std::size_t i) {
    Vec3& f = force[i];
    f = response.force[i];
    f += contact_.force_at(i);
    f += load_[i] - solid.mass[i] / squared_time(islands_.of(i)) * (u[i] - target_[i]);
    if (is_fixed(env, i)) f.setZero();
  });
}

void IncrementalPotential::multiply(const ActiveIslands& active, const std::vector<Vec3>& p, std::vector<Vec3>& out,
                                    std::vector<double>& curvature) {
  const SolidDiscretisation& solid = problem_.solid;
  elastic_.multiply(active, p);
  contact_.multiply_hessian(p);
  const auto product_at = [&](std::size_t i) -> Vec3 {
    return elastic_.product_at(i) + inertia_[i] * p[i] + contact_.hessian_product_at(i);
  };
  if (solid.penalty) {
    active.each_node([&](std::size_t i) { out[i] = product_at(i); });
    solid.penalty->add(solid.mls, p, &out);
  }
  active.sum(curvature, 0.0, [&](std::size_t i) {
    if (is_fixed(problem_.environment, i))
      out[i].setZero();
    else if (!solid.penalty)
      out[i] = product_at(i);
    return p[i].dot(out[i]);
  });
}

std::vector<Mat3> IncrementalPotential::nodal_blocks_with_contact() const {
  std::vector<Mat3> blocks(inertia_.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = inertia_[i] * Mat3::Identity();
  contact_.add_diagonal_blocks(blocks);
  return blocks;
}

std::vector<std::uint8_t> IncrementalPotential::interrupted() const {
  std::vector<std::uint8_t> nodes(target_.size(), 0), islands(islands_.count(), 0);
  contact_.mark_interrupted(nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i]) islands[islands_.of(i)] = 1;
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = islands[islands_.of(i)];
  return nodes;
}

}  // namespace geo
