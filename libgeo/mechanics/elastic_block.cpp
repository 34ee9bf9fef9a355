#include "mechanics/elastic_block.h"

#include <algorithm>

namespace geo {

ElasticBlock::ElasticBlock(const BlockStrain& strain, const Materials& materials, double dt) : strain_(strain) {
  for (const Material& m : materials.all()) constants_.push_back(elastic_constants(m, dt));
}

// Points that stand among others are worked out with these, aside, and only they are taken.
void ElasticBlock::evaluate_run(const PointBlock& block, const MaterialRun& run, const PointHistory& history, Columns<float>* deformed) {
  const ElasticConstants& of = constants_[run.material];
  const PointHistory own{of.flows ? history.relaxed : nullptr, of.viscosity > 0 ? history.before : nullptr};
  if (run.alone) return elastic_points(of, run.begin, run.end, volume_, own, gradient_, energy_, deformed);
  aside_.gradient.resize(block.points.size()), aside_.energy.resize(energy_.size()), aside_.deformed.resize(block.points.size());
  for (int c = 0; c < 3; ++c) std::copy_n(&gradient_.column[c][4 * run.begin], 4 * (run.end - run.begin), &aside_.gradient.column[c][4 * run.begin]);
  elastic_points(of, run.begin, run.end, volume_, own, aside_.gradient, aside_.energy, deformed ? &aside_.deformed : nullptr);
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (!block.is_of(run, i)) continue;
    energy_[i] = aside_.energy[i];
    for (int c = 0; c < 3; ++c) {
      std::copy_n(&aside_.gradient.column[c][4 * i], 4, &gradient_.column[c][4 * i]);
      if (deformed) std::copy_n(&aside_.deformed.column[c][4 * i], 4, &deformed->column[c][4 * i]);
    }
  }
}

const std::vector<double>& ElasticBlock::evaluate(std::size_t block, const std::vector<Vec3>& u, const PointHistory& history, Columns<float>* deformed, double* pull) {
  const PointBlock& b = strain_.points().blocks[block];
  strain_.gradients(block, u, room_, gradient_);
  volume_.assign((b.points.size() + 7) / 8 * 8, 0);
  for (std::size_t i = 0; i < b.points.size(); ++i)
    if (b.points[i].rung != Rung::rigid) volume_[i] = b.points[i].volume;
  if (deformed) deformed->resize(b.points.size());
  energy_.resize(volume_.size());
  for (const MaterialRun& run : b.runs) evaluate_run(b, run, history, deformed);
  if (pull) strain_.pull(block, gradient_, room_, pull);
  return energy_;
}

}  // namespace geo
