// Energies and forces are summed block by block, then over blocks in their order, so that they do
// not depend on threads. Strains here are always in double precision.
#include "mechanics/solver/solid_discretisation.h"

#include <algorithm>
#include <numeric>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/elastic_block.h"
#include "mechanics/discretisation/point_transfer.h"
#include "mechanics/material/plasticity.h"

namespace geo {

void SolidDiscretisation::update_nodal_points(std::span<const NodeId> updated) {
  constexpr std::size_t nodes_per_block = 256;
  const std::size_t n = mls.size(), count = (n + nodes_per_block - 1) / nodes_per_block, before = points.blocks.size();
  std::vector<char> stale(count, 0);
  for (const NodeId i : updated) stale[i.index() / nodes_per_block] = 1;
  points.blocks.resize(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      std::vector<MaterialPoint> block_points;
      std::vector<ShapeGradients> stencils;
      for (std::size_t i = b * nodes_per_block; i < std::min(n, (b + 1) * nodes_per_block); ++i) {
        block_points.push_back({.position = position[i],
                                .volume = volume[i],
                                .quality = mls.quality(i),
                                .widenings = 0,
                                .occluded = false,
                                .material = 0,
                                .influence_radius = 0,
                                .unscaled_volume = volume[i]});
        if (stale[b] || b >= before)
          stencils.push_back(mls.quality(i) == MomentQuality::singular ? ShapeGradients{} : mls.shape_gradients(i));
      }
      if (stale[b] || b >= before)
        points.blocks[b] = PointBlock(std::move(block_points), stencils);
      else
        points.blocks[b].points = std::move(block_points);  // volumes are halved without a change of neighbours
    }
  });
  points.number_points(n);
  points.set_materials(materials);
  build_preconditioner_levels();
  update_mode_penalty();
}

void SolidDiscretisation::update_mode_penalty() {
  if (galerkin) return;
  std::vector<double> weight;
  for (std::size_t i = 0; i < size(); ++i)
    weight.push_back(materials.of(i).mode_penalty * materials.of(i).young * volume[i]);
  penalty.emplace(mls, std::move(weight));
}

void SolidDiscretisation::update_quadrature_points(const Body& body, State& state, SubdomainInverses& inverses) {
  PointChanges changes;
  const PointTransfer plastic(points, position, changed, state.plastic);
  const PointTransfer prestretch(points, position, changed, state.prestretch);
  parallel_invoke(
      [&] { aggregates = Aggregates(position, mls, component, components); },
      [&] {
        held.restore(points);
        const double reach = HeldMaterial::reach_of(body.nodes);
        changes =
            galerkin->rebuild_changed(body, component, points, [&](const Vec3& x) { return held.is_near(x, reach); });
        points.set_materials(materials);
        inverses.update(subdomains,
                        subdomains.update({.position = position, .mls = mls, .spacing = spacing, .points = points},
                                          changed, changes));
      });
  update_as_rigid();
  apply_held(body, &changes);
  changed.clear();
  if (changes.old_point.empty()) return;
  state.plastic = plastic.after(points, position, changes.old_point, Mat3::Zero());
  state.prestretch = prestretch.after(points, position, changes.old_point, Mat3::Identity());
}

void SolidDiscretisation::update_as_rigid() {
  // A point has six strains, a node three unknowns: one point a node is twice what determines them.
  // As sampled, bodies have more than two.
  constexpr double enough = 1;
  std::vector<double> stiffness = points.shares(size());
  for (std::size_t i = 0; i < size(); ++i)
    stiffness[i] = std::max(0.0, 1 - stiffness[i] / enough) * materials.of(i).young * volume[i];
  as_rigid = AsRigidEnergy(mls, stiffness);
}

void SolidDiscretisation::hold(const Body& body, std::span<const HeldBox> boxes) {
  if (!galerkin || !held.set_boxes(boxes)) return;
  held.restore(points);
  points.number_points(size());
  apply_held(body, nullptr);
}

void SolidDiscretisation::apply_held(const Body& body, PointChanges* changes) {
  if (!held.apply(body, component, changes, points)) return;
  points.number_points(size());
  points.set_materials(materials);
}

void SolidDiscretisation::build_preconditioner_levels() {
  aggregates = Aggregates(position, mls, component, components);
  subdomains = Subdomains({.position = position, .mls = mls, .spacing = spacing, .points = points});
}

double SolidDiscretisation::elastic_energy(const std::vector<Vec3>& u, std::vector<Vec3>* force,
                                           const std::vector<PointRelaxation>& relaxation) const {
  std::vector<double> energy(points.blocks.size(), 0), block_sums(force ? 4 * points.scatter_size() : 0);
  const BlockStrain strain(points);
  parallel_for(energy.size(), 1, [&](std::size_t begin, std::size_t end) {
    ElasticBlock::Scratch scratch;
    ElasticBlock elastic(scratch, strain, materials);
    for (std::size_t b = begin; b < end; ++b) {
      const PointHistory history = relaxation.empty() ? PointHistory{} : relaxation[b].history();
      const auto& of_point =
          elastic.evaluate(b, u, history, nullptr, force ? block_sums.data() + 4 * points.scatter_offset(b) : nullptr);
      energy[b] = std::accumulate(of_point.begin(), of_point.end(), 0.0);
    }
  });
  if (force) {
    force->resize(size());
    parallel_for(size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const auto sum = points.sum_at_node<4>(block_sums.data(), j);
        (*force)[j] = {sum[0], sum[1], sum[2]};
      }
    });
  }
  double sum = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (penalty) sum += penalty->add(mls, u, force);
  if (force)
    for (Vec3& f : *force) f = -f;
  for (std::size_t k = 0; k < as_rigid.size(); ++k) {
    Mat3 rotation;
    sum += as_rigid.energy(k, u, rotation);
    if (force) as_rigid.add_force(k, u, rotation, *force);
  }
  return sum;
}

std::vector<PointRelaxation> SolidDiscretisation::relaxation_of(const State& state) const {
  if (!state.plastic.empty() && state.plastic.size() != points.size())
    throw InputError("the plastic strains are not those of this solid");
  if (!state.prestretch.empty() && state.prestretch.size() != points.size())
    throw InputError("the prestretch is not that of this solid");
  const bool relaxes = (is_plastic() && !state.plastic.empty()) || !state.prestretch.empty();
  std::vector<PointRelaxation> all(relaxes ? points.blocks.size() : 0);
  parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) all[b] = geo::relaxation_of(points, b, state);
  });
  return all;
}

void SolidDiscretisation::update_plasticity(State& state, double dt) const {
  if (!is_plastic()) return;
  state.plastic.resize(points.size(), Mat3::Zero());
  const auto of_stretched = [&](const Mat3& f, std::size_t point) {
    return state.prestretch.empty() ? f : Mat3(f * state.prestretch[point]);
  };
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto gradient = points.gradients(b, state.displacement);
      for (std::size_t i = 0; i < gradient.size(); ++i) {
        Mat3& plastic = state.plastic[points.first_point(b) + i];
        const Material& material = materials[points.blocks[b].points[i].material];
        if (material.yield > 0 && points.blocks[b].points[i].quality != MomentQuality::singular)
          plastic = plastic_flow(material, plastic,
                                 of_stretched(Mat3::Identity() + gradient[i], points.first_point(b) + i), dt);
      }
    }
  });
}

}  // namespace geo
