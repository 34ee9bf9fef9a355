#include "mechanics/discretisation/elastic_block.h"

#include <algorithm>

namespace geo {

ElasticBlock::ElasticBlock(Room& room, const BlockStrain& strain, const Materials& materials, double dt)
    : room_(room), strain_(strain) {
  for (const Material& m : materials.all()) constants_.push_back(elastic_constants(m, dt));
}

// Points that stand among others are worked out with these, aside, and only they are taken.
void ElasticBlock::evaluate_run(const PointBlock& block, const MaterialRun& run, const PointHistory& history,
                                Columns<float>* deformed) {
  const ElasticConstants& of = constants_[run.material];
  const PointHistory own{of.flows ? history.relaxed : nullptr, of.viscosity > 0 ? history.before : nullptr};
  if (run.alone)
    return elastic_points(of, run.begin, run.end, room_.volume, own, room_.gradient, room_.energy, deformed);
  room_.aside.gradient.resize(block.points.size()), room_.aside.energy.resize(room_.energy.size()),
      room_.aside.deformed.resize(block.points.size());
  for (int c = 0; c < 3; ++c)
    std::copy_n(&room_.gradient.column[c][4 * run.begin], 4 * (run.end - run.begin),
                &room_.aside.gradient.column[c][4 * run.begin]);
  elastic_points(of, run.begin, run.end, room_.volume, own, room_.aside.gradient, room_.aside.energy,
                 deformed ? &room_.aside.deformed : nullptr);
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (!block.is_of(run, i)) continue;
    room_.energy[i] = room_.aside.energy[i];
    for (int c = 0; c < 3; ++c) {
      std::copy_n(&room_.aside.gradient.column[c][4 * i], 4, &room_.gradient.column[c][4 * i]);
      if (deformed) std::copy_n(&room_.aside.deformed.column[c][4 * i], 4, &deformed->column[c][4 * i]);
    }
  }
}

const std::vector<double>& ElasticBlock::evaluate(std::size_t block, const std::vector<Vec3>& u,
                                                  const PointHistory& history, Columns<float>* deformed, double* pull) {
  const PointBlock& b = strain_.points().blocks[block];
  strain_.gradients(block, u, room_.strain, room_.gradient);
  room_.volume.assign((b.points.size() + 7) / 8 * 8, 0);
  for (std::size_t i = 0; i < b.points.size(); ++i)
    if (b.points[i].rung != Rung::rigid) room_.volume[i] = b.points[i].volume;
  if (deformed) deformed->resize(b.points.size());
  room_.energy.resize(room_.volume.size());
  for (const MaterialRun& run : b.runs) evaluate_run(b, run, history, deformed);
  if (pull) strain_.pull(block, room_.gradient, room_.strain, pull);
  return room_.energy;
}

}  // namespace geo
