// Elastic energy before and after single cuts of strained bodies.
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/validation.h"

namespace validation {
namespace {

using namespace geo;

struct Changes {
  double most = 0, sum = 0;  // of the energy before a cut: largest rise, of all changes
  int cuts = 0;
};

// Blocks that are strained at random, linearly and by a bend, and cut at random in
// steps.
Changes cut_at_random(double spacing, double most_bend, std::uint64_t first, int bodies) {
  Changes all;
  for (std::uint64_t seed = first; seed < first + std::uint64_t(bodies); ++seed) {
    Random random(seed);
    Body body = block_body({1, 1, 1}, spacing);
    Material material;
    material.young = 1e5;
    material.poisson = 0.3;
    Solid solid(body, material);
    const std::vector<Vec3> zero(body.nodes.size(), Vec3::Zero());
    State state{zero, zero};
    Mat3 linear;
    for (int i = 0; i < 9; ++i) linear.data()[i] = random.uniform(-0.1, 0.1);
    const Vec3 bend = random.uniform(0, most_bend) * random.direction(), along = random.direction();
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      const Vec3 x = body.nodes.position[i] - Vec3(0.5, 0.5, 0.5);
      state.displacement[i] = linear * x + bend * std::pow(along.dot(x), 2);
    }
    const Vec3 normal = random.direction(), side = normal.unitOrthogonal(), way = normal.cross(side),
               middle = Vec3(0.5, 0.5, 0.5) + random.uniform(-0.3, 0.3) * normal;
    const int steps = 3 + int(random.below(5));
    const Vec3 a = middle - side - way, b = middle + side - way, step = random.uniform(0.4, 2.4) / steps * way;
    auto front = begin_front(blade_at(a, b, step, 0, 3), false, 1);
    for (int k = 1; k <= steps; ++k, ++all.cuts) {
      const double before = solid.energy(state.displacement);
      solid.update(body, split(body, front, blade_at(a, b, step, k, 3)), state);
      const double rise = solid.energy(state.displacement) / before - 1;
      all.most = std::max(all.most, most_bend > 0 ? rise : std::abs(rise));
      all.sum += rise;
    }
  }
  return all;
}

}  // namespace

std::vector<Finding> energy_at_cuts(int) {
  std::vector<Finding> found;
  const Changes linear = cut_at_random(0.2, 0, 1, 60);
  found.push_back(
      {std::to_string(linear.cuts) + " cuts of blocks under linear strain: largest change of the energy, relative",
       "U after = U before, but in slivers with fewer points than nodes", linear.most, 0, 0.005, true});
  const Changes bent = cut_at_random(0.2, 0.3, 1, 60);
  const std::string cuts = std::to_string(bent.cuts) + " cuts of bent blocks, nodes 0.2 apart: ";
  found.push_back({cuts + "largest rise of the energy, relative", "U after ≤ U before", bent.most, 0, 0.04, true});
  found.push_back({cuts + "mean change of the energy, relative", "≤ 0, to what the sampling tells",
                   bent.sum / bent.cuts, 0, 0.002, true});
  return found;
}

}  // namespace validation
