// Gather, law, scatter: ∇u at the points, energy and stress by ranges of one material, then nodal
// forces f_j = Σ_p V_p P_p g_pj. P is the first Piola–Kirchhoff stress, g_pj the shape gradient.
#include "mechanics/discretisation/elastic_block.h"

#include <algorithm>

namespace geo {

ElasticBlock::ElasticBlock(Scratch& scratch, const BlockStrain& strain, const Materials& materials, double dt)
    : scratch_(scratch), strain_(strain) {
  for (const Material& m : materials.all()) constants_.push_back(elastic_constants(m, dt));
}

// In a range of mixed materials, all points are evaluated with the range's material, and results of
// points that have another one are discarded.
void ElasticBlock::evaluate_range(const PointBlock& block, const MaterialRange& range, const PointHistory& history,
                                  PointMatrices<float>* elastic_gradient) {
  const ElasticConstants& constants = constants_[range.material];
  const bool relaxes = constants.yields || history.share != nullptr;
  const PointHistory used{.relaxation = relaxes ? history.relaxation : nullptr,
                          .previous_gradient = constants.viscosity > 0 ? history.previous_gradient : nullptr};
  const PointRange points{range.begin, range.end};
  if (range.uniform)
    return elastic_response(constants, points, scratch_.volume, used, scratch_.gradient, scratch_.energy,
                            elastic_gradient);
  auto& mixed = scratch_.mixed;
  mixed.gradient.resize(block.points.size());
  mixed.energy.resize(scratch_.energy.size());
  mixed.elastic_gradient.resize(block.points.size());
  for (int c = 0; c < 3; ++c)
    std::copy_n(&scratch_.gradient.column[c][4 * range.begin], 4 * (range.end - range.begin),
                &mixed.gradient.column[c][4 * range.begin]);
  elastic_response(constants, points, scratch_.volume, used, mixed.gradient, mixed.energy,
                   elastic_gradient ? &mixed.elastic_gradient : nullptr);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    if (!block.belongs_to(range, i)) continue;
    scratch_.energy[i] = mixed.energy[i];
    for (int c = 0; c < 3; ++c) {
      std::copy_n(&mixed.gradient.column[c][4 * i], 4, &scratch_.gradient.column[c][4 * i]);
      if (elastic_gradient)
        std::copy_n(&mixed.elastic_gradient.column[c][4 * i], 4, &elastic_gradient->column[c][4 * i]);
    }
  }
}

const std::vector<double>& ElasticBlock::evaluate(std::size_t block, const std::vector<Vec3>& u,
                                                  const PointHistory& history, PointMatrices<float>* elastic_gradient,
                                                  double* force) {
  const PointBlock& b = strain_.points().blocks[block];
  strain_.gradients(block, u, scratch_.strain, scratch_.gradient);
  scratch_.volume.assign((b.points.size() + 7) / 8 * 8, 0);
  for (std::size_t i = 0; i < b.points.size(); ++i)
    if (b.points[i].quality != MomentQuality::singular)
      scratch_.volume[i] = history.share ? (*history.share)[i] * b.points[i].volume : b.points[i].volume;
  if (elastic_gradient) elastic_gradient->resize(b.points.size());
  scratch_.energy.resize(scratch_.volume.size());
  for (const MaterialRange& range : b.material_ranges) evaluate_range(b, range, history, elastic_gradient);
  if (force) strain_.nodal_forces(block, scratch_.gradient, scratch_.strain, force);
  return scratch_.energy;
}

}  // namespace geo
