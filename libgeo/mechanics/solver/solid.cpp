// Solid of kerf/solid.h, except for its time steps. Solid forwards to SolidDiscretisation. Computed
// here: Cauchy stress σ = P Fᵀ / J averaged by kernel weights, momenta, and kinetic energy.
#include "kerf/solid.h"

#include <algorithm>
#include <cmath>

#include "kerf/error.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "mechanics/solver/solver_cache.h"

namespace geo {
namespace {

std::vector<NodeId> all_nodes(std::size_t count) {
  std::vector<NodeId> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = NodeId(i);
  return all;
}

Indirect<SolidDiscretisation> empty_discretisation(Materials materials, std::size_t nodes) {
  if (!materials.fits(nodes)) throw InputError("a solid of several materials needs one for each node");
  return Indirect<SolidDiscretisation>::of(SolidDiscretisation(std::move(materials)));
}

}  // namespace

Solid::Solid(const Body& body, Materials materials)
    : discretisation_(empty_discretisation(std::move(materials), body.nodes.size())),
      cache_(Indirect<SolverCache>::of({})) {
  SolidDiscretisation& d = *discretisation_;
  State no_motion;
  d.update_nodes(body.nodes, body.graph, NodeId(body.nodes.size()), {}, all_nodes(body.nodes.size()), no_motion);
  if (d.materials.discretisation() == Discretisation::galerkin) {
    d.galerkin.emplace(body, d.component, d.points);
    d.points.set_materials(d.materials);
    d.update_as_rigid();
    d.build_preconditioner_levels();
  } else {
    d.update_nodal_points(all_nodes(body.nodes.size()));
  }
}

Solid::Solid(const NodeSet& nodes, const VisibilityGraph& graph, Materials materials)
    : discretisation_(empty_discretisation(std::move(materials), nodes.size())), cache_(Indirect<SolverCache>::of({})) {
  discretisation_->materials.set_discretisation(Discretisation::mueller04);
  State no_motion;
  update(nodes, graph, NodeId(nodes.size()), {}, all_nodes(nodes.size()), no_motion);
}

void Solid::update(const Body& body, const BodyDelta& delta, State& state) {
  update_nodes(body, delta, state);
  update_points(body, state);
}

void Solid::update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
                   std::span<const NodeId> updated, State& state) {
  discretisation_->update_nodes(nodes, graph, first_new, donors, updated, state);
  discretisation_->update_nodal_points(updated);
  cache_->inverses = {};
}

void Solid::update_nodes(const Body& body, const BodyDelta& delta, State& state) {
  SolidDiscretisation& d = *discretisation_;
  std::vector<Vec3> old_position;
  for (const NodeId i : delta.moved_nodes) old_position.push_back(d.position[i.index()]);
  d.update_nodes(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state,
                 !delta.detached.empty());
  if (!d.galerkin) {
    d.update_nodal_points(delta.updated_nodes);
    cache_->inverses = {};
    return;
  }
  d.galerkin->mark_changed(body, delta, old_position);
  d.changed.resize(size(), 0);
  for (const NodeId i : delta.updated_nodes) d.changed[i.index()] = 1;
}

void Solid::update_points(const Body& body, State& state) {
  SolidDiscretisation& d = *discretisation_;
  if (!d.galerkin || !d.galerkin->has_changes()) return;
  d.update_quadrature_points(body, state, cache_->inverses);
}

void Solid::hold(const Body& body, std::span<const HeldBox> boxes) {
  for (const HeldBox& box : boxes)
    if (!(box.lo.array() <= box.hi.array()).all()) throw InputError("a held box has lo > hi; exchange its corners");
  discretisation_->hold(body, boxes);
}

void Solid::set_materials(const Materials& materials) {
  SolidDiscretisation& d = *discretisation_;
  bool same = materials.count() == d.materials.count() && materials.fits(size());
  for (std::size_t m = 0; same && m < materials.count(); ++m)
    same =
        materials[m].density == d.materials[m].density && materials[m].discretisation == d.materials[m].discretisation;
  for (std::size_t i = 0; same && i < size(); ++i) same = materials.index(i) == d.materials.index(i);
  if (!same) throw InputError("a solid keeps its densities, its discretisation and the materials of its nodes");
  d.materials = materials;
  d.update_mode_penalty();
}

std::size_t Solid::size() const { return discretisation_->size(); }
double Solid::mass(NodeId i) const { return discretisation_->mass[i.index()]; }
const Materials& Solid::materials() const { return discretisation_->materials; }
std::size_t Solid::point_count() const { return discretisation_->points.size(); }

std::vector<Vec3> Solid::point_positions() const {
  std::vector<Vec3> positions;
  for (const PointBlock& b : discretisation_->points.blocks)
    for (const MaterialPoint& p : b.points) positions.push_back(p.position);
  return positions;
}

std::vector<Mat3> Solid::gradients(const std::vector<Vec3>& u) const { return discretisation_->mls.gradients(u); }

MomentQualityCounts Solid::moment_quality_counts() const {
  const SolidDiscretisation& d = *discretisation_;
  MomentQualityCounts counts;
  for (std::size_t i = 0; i < d.size(); ++i) ++counts.nodes[static_cast<std::size_t>(d.mls.quality(i))];
  for (const PointBlock& b : d.points.blocks)
    for (const MaterialPoint& p : b.points) {
      ++counts.points[static_cast<std::size_t>(p.quality)];
      counts.widened += p.widenings > 0;
    }
  return counts;
}

void Solid::gradient_stencil(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const {
  const auto& stencil = discretisation_->mls[i.index()];
  for (std::size_t q = 0; q < stencil.neighbors.size(); ++q)
    out.push_back({NodeId(stencil.neighbors[q]), stencil.gradient[q]});
  out.push_back({i, stencil.own_gradient});
}

void Solid::set_rotations(const State& state) { discretisation_->mls.set_rotations(state.rotation); }

double Solid::energy(const std::vector<Vec3>& u) const { return discretisation_->elastic_energy(u, nullptr); }

double Solid::energy(const State& state) const {
  return discretisation_->elastic_energy(state.displacement, nullptr, discretisation_->relaxation_of(state));
}

std::vector<Vec3> Solid::forces(const std::vector<Vec3>& u) const {
  std::vector<Vec3> f;
  discretisation_->elastic_energy(u, &f);
  return f;
}

std::vector<Vec3> Solid::forces(const State& state) const {
  std::vector<Vec3> f;
  discretisation_->elastic_energy(state.displacement, &f, discretisation_->relaxation_of(state));
  return f;
}

Mat3 Solid::stress_at(const State& state, const Vec3& x, double radius,
                      const std::function<bool(const Vec3&)>& sees) const {
  const SolidDiscretisation& d = *discretisation_;
  Mat3 sum = Mat3::Zero();
  double total = 0;
  for (std::size_t b = 0; b < d.points.blocks.size(); ++b) {
    const PointBlock& block = d.points.blocks[b];
    if (!block.box.meets(Box3{x, x}.grown(radius))) continue;
    std::vector<Mat3> gradient;
    PointRelaxation relaxation;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      const MaterialPoint& p = block.points[i];
      const double w = p.volume * kernel((p.position - x).norm() / radius, 1.0);
      if (!(w > 0) || p.quality == MomentQuality::singular || (sees && !sees(p.position))) continue;
      if (gradient.empty()) {
        gradient = d.points.gradients(b, state.displacement);
        relaxation = relaxation_of(d.points, b, state);
      }
      Mat3 f = Mat3::Identity() + gradient[i];
      if (!relaxation.empty()) f = f * relaxation.at(i);
      const double j = f.determinant();
      if (!(j > 0)) continue;  // inverted: it has no Cauchy stress
      const Mat3 cauchy = stress(d.materials[p.material], f) * f.transpose() / j;
      sum += 0.5 * w * (cauchy + cauchy.transpose());
      total += w;
    }
  }
  return total > 0 ? Mat3(sum / total) : sum;
}

Vec3 Solid::momentum(const State& state) const {
  const std::vector<double>& mass = discretisation_->mass;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < size(); ++i) sum += mass[i] * state.velocity[i];
  return sum;
}

Vec3 Solid::angular_momentum(const State& state) const {
  const SolidDiscretisation& d = *discretisation_;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < size(); ++i)
    sum += d.mass[i] * (d.position[i] + state.displacement[i]).cross(state.velocity[i]);
  return sum;
}

double Solid::kinetic_energy(const State& state) const {
  const std::vector<double>& mass = discretisation_->mass;
  double sum = 0;
  for (std::size_t i = 0; i < size(); ++i) sum += 0.5 * mass[i] * state.velocity[i].squaredNorm();
  return sum;
}

}  // namespace geo
