// Matrix-free: each block of points writes its nodal sums to slots of its own, then each node adds
// up its slots. K p = Σ Bᵀ D B p, with B the displacement gradient at a point and D its projected
// stiffness.
#include "mechanics/solver/elastic_potential.h"

#include <algorithm>

#include "kerf/parallel.h"
#include "mechanics/discretisation/elastic_block.h"
#include "mechanics/discretisation/stiffness_product_lanes.h"

namespace geo {
namespace {

// Near incompressibility, pressure amplifies the rounding error of the strain by λ/μ: beyond a
// ratio of 50, or where an accuracy of 0.005 spacings or better is required, strains are in double
// precision.
BlockStrain strain_for(const StepProblem& problem) {
  constexpr double loose_accuracy = 0.005, largest_ratio = 50;
  const SolidDiscretisation& solid = problem.solid;
  const bool exact =
      problem.accuracy < loose_accuracy || !problem.smooth.empty() ||
      solid.materials.any([](const Material& m) { return m.lambda() + m.volume_term > largest_ratio * m.mu(); });
  return exact ? BlockStrain(solid.points)
               : BlockStrain(solid.points, solid.position, solid.component, problem.start.displacement);
}

}  // namespace

ElasticPotential::ElasticPotential(const StepProblem& problem)
    : solid_(problem.solid),
      dt_(problem.dt),
      strain_(strain_for(problem)),
      relaxation_(solid_.relaxation_of(problem.start)) {
  const std::size_t blocks = solid_.points.blocks.size();
  stiffness_.modes.resize(blocks);
  stiffness_.weight.resize(blocks);
  const bool viscous = solid_.materials.any([](const Material& m) { return m.viscosity > 0; });
  if (viscous) start_gradient_.resize(blocks);
  parallel_for(blocks, 4, [&](std::size_t begin, std::size_t end) {
    BlockStrain::Scratch scratch;
    for (std::size_t b = begin; b < end; ++b) {
      const auto& points = solid_.points.blocks[b].points;
      std::vector<float>& weight = stiffness_.weight[b];
      weight.assign((points.size() + 7) / 8 * 8, 0);
      for (std::size_t i = 0; i < points.size(); ++i)
        weight[i] = points[i].quality == MomentQuality::singular ? 0.0f : float(volume_of(b, i));
      if (viscous) strain_.gradients(b, problem.start.displacement, scratch, start_gradient_[b]);
    }
  });
}

// The volume of a point without stress.
double ElasticPotential::volume_of(std::size_t block, std::size_t point) const {
  const double volume = solid_.points.blocks[block].points[point].volume;
  return relaxation_.empty() ? volume : relaxation_[block].share_at(point) * volume;
}

void ElasticPotential::evaluate(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& energy,
                                ElasticResponse* response) {
  const MaterialPoints& points = solid_.points;
  const Islands& islands = active.islands();
  const auto blocks = active.blocks();
  block_energy_.resize(islands.block_first(points.blocks.size()));
  block_forces_.resize(4 * points.scatter_size());
  if (response) {
    response->energy.resize(islands.count());
    response->force.resize(solid_.size());
    response->deformation.resize(points.blocks.size());
  }
  std::vector<double> island_energy(islands.count(), 0);
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    thread_local ElasticBlock::Scratch
        scratch;  // 100 bytes per point: too many to allocate and to clear for each block
    ElasticBlock elastic(scratch, strain_, solid_.materials, dt_);
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t b = blocks[k];
      PointHistory history = relaxation_.empty() ? PointHistory{} : relaxation_[b].history();
      history.previous_gradient = start_gradient_.empty() ? nullptr : &start_gradient_[b];
      const auto& point_energy =
          elastic.evaluate(b, u, history, response ? &response->deformation[b] : nullptr,
                           response ? block_forces_.data() + 4 * points.scatter_offset(b) : nullptr);
      double* const sums = block_energy_.data() + islands.block_first(b);
      std::fill_n(sums, islands.of_block(b).size(), 0.0);
      for (std::size_t i = 0; i < points.blocks[b].points.size(); ++i)
        sums[islands.slot(b, points.blocks[b], i)] += point_energy[i];
    }
  });
  for (const auto b : blocks) {
    const double* sum = block_energy_.data() + islands.block_first(b);
    for (const auto p : islands.of_block(b)) island_energy[p] += *sum++;
  }
  if (response)
    active.each_node([&](std::size_t i) {
      const auto sum = points.sum_at_node<4>(block_forces_.data(), i);
      response->force[i] = -Vec3(sum[0], sum[1], sum[2]);
    });
  add_stars(active, u, island_energy, response);
  if (solid_.penalty) {  // it joins all components: there is one island
    std::vector<Vec3> gradient(response ? solid_.size() : 0, Vec3::Zero());
    island_energy[0] += solid_.penalty->add(solid_.mls, u, response ? &gradient : nullptr);
    for (std::size_t i = 0; i < gradient.size(); ++i) response->force[i] -= gradient[i];
  }
  for (std::size_t p = 0; p < islands.count(); ++p) {
    if (!active[p]) continue;
    energy[p] += island_energy[p];
    if (response) response->energy[p] = island_energy[p];
  }
}

void ElasticPotential::add_stars(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& energy,
                                 ElasticResponse* response) const {
  const AsRigidEnergy& stars = solid_.as_rigid;
  if (response) response->rotation.resize(stars.size());
  for (std::size_t k = 0; k < stars.size(); ++k) {
    const auto island = active.islands().of(stars.node(k));
    if (!active[island]) continue;
    Mat3 rotation;
    energy[island] += stars.energy(k, u, rotation);
    if (!response) continue;
    response->rotation[k] = rotation;
    stars.add_force(k, u, rotation, response->force);
  }
}

void ElasticPotential::linearise(const ActiveIslands& active, const ElasticResponse& response) {
  rotation_.resize(solid_.as_rigid.size());
  for (std::size_t k = 0; k < rotation_.size(); ++k)
    if (active[active.islands().of(solid_.as_rigid.node(k))]) rotation_[k] = response.rotation[k];
  std::vector<StiffnessConstants> constants;  // per material
  for (const Material& m : solid_.materials.all()) {
    constants.push_back(stiffness_constants(m));
    constants.back().viscous = float(m.viscosity / dt_);
  }
  const auto blocks = active.blocks();
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    PointMatrices<float> relaxation;
    StiffnessModes scratch;
    for (std::size_t k = begin; k < end; ++k)
      linearise_block(blocks[k], constants, response.deformation[blocks[k]], relaxation, scratch);
  });
}

void ElasticPotential::linearise_block(std::size_t block, const std::vector<StiffnessConstants>& constants,
                                       const PointMatrices<float>& deformation, PointMatrices<float>& relaxation,
                                       StiffnessModes& scratch) {
  const PointBlock& points = solid_.points.blocks[block];
  const std::vector<float>& weight = stiffness_.weight[block];
  StiffnessModes& modes = stiffness_.modes[block];
  if (!relaxation_.empty()) {
    relaxation.resize(points.points.size());
    for (int c = 0; c < 3; ++c)
      std::copy(relaxation_[block].matrix.column[c].begin(), relaxation_[block].matrix.column[c].end(),
                relaxation.column[c].begin());
  }
  modes.resize(weight.size());
  for (const MaterialRange& run : points.material_ranges) {
    const bool relaxes =
        !relaxation_.empty() && (solid_.materials[run.material].yield > 0 || !relaxation_[block].share.empty());
    // In a range of mixed materials, all points are computed with the range's material, and results
    // of other materials' points are dropped.
    StiffnessModes& out = run.uniform ? modes : scratch;
    out.resize(weight.size());
    stiffness_modes(constants[run.material], {run.begin, run.end}, deformation, relaxes ? &relaxation : nullptr, weight,
                    out);
    for (std::size_t i = run.begin; i < run.end && !run.uniform; ++i)
      if (points.belongs_to(run, i)) modes.copy_point(scratch, i);
  }
}

void ElasticPotential::multiply(const ActiveIslands& active, const std::vector<Vec3>& p) {
  const AsRigidEnergy& stars = solid_.as_rigid;
  star_product_.assign(stars.empty() ? 0 : solid_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < stars.size(); ++k)
    if (active[active.islands().of(stars.node(k))]) stars.add_product(k, rotation_[k], p, star_product_);
  const MaterialPoints& points = solid_.points;
  block_products_.resize(4 * points.scatter_size());
  const auto blocks = active.blocks();
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> values;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t b = blocks[k];
      const PointBlock& block = points.blocks[b];
      values.resize(4 * block.nodes.size());
      // Differences from the block's first node, in double precision: a common translation has no
      // strain, and would cost digits in single precision.
      const Vec3 base = p[block.nodes[0]];
      for (std::size_t j = 0; j < block.nodes.size(); ++j) {
        const Vec3 difference = p[block.nodes[j]] - base;
        for (std::size_t c = 0; c < 3; ++c) values[4 * j + c] = float(difference[static_cast<Eigen::Index>(c)]);
      }
      float* const out = block_products_.data() + 4 * points.scatter_offset(b);
      std::fill(out, out + 4 * block.nodes.size(), 0.0f);
      multiply_stiffness(block, stiffness_.modes[b], values.data(), out);
    }
  });
}

}  // namespace geo
