#include "mechanics/elastic_block.h"

#include <algorithm>

namespace geo {

const std::vector<double>& ElasticBlock::evaluate(const MaterialPoints& points, std::size_t block, const std::vector<Vec3>& u, const PointHistory& history,
                                                  Columns<float>* deformed, double* pull) {
  const PointBlock& b = points.blocks[block];
  points.values(block, u, values_);
  point_gradients(b, values_.data(), gradient_);
  volume_.assign((b.points.size() + 7) / 8 * 8, 0);
  for (std::size_t i = 0; i < b.points.size(); ++i)
    if (b.points[i].rung != Rung::rigid) volume_[i] = b.points[i].volume;
  if (deformed) deformed->resize(b.points.size());
  elastic_points(constants_, volume_, history, gradient_, energy_, deformed);
  if (pull) {
    std::fill_n(pull, 4 * b.nodes.size(), 0.0);
    point_divergence(b, gradient_, pull);
  }
  return energy_;
}

}  // namespace geo
