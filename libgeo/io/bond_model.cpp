// find_bond_model() of kerf/peridynamics.h. A bond is broken where a face touches it, by the exact
// test that decides the edges of the visibility graph.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/bvh.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/peridynamics.h"
#include "sampling/node_grid.h"

namespace geo {
namespace {

// Blocks of equal horizons: spacings rounded to powers of two, from the finest up.
void set_blocks(const NodeSet& nodes, double horizon, BondModel& model) {
  const double finest = *std::min_element(nodes.spacing.begin(), nodes.spacing.end());
  std::vector<int> level(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    level[i] = static_cast<int>(std::lround(std::log2(nodes.spacing[i] / finest)));
  std::vector<int> levels = level;
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  for (const int l : levels) model.horizon.push_back(horizon * std::ldexp(finest, l));
  for (const int l : level)
    model.block.push_back(
        static_cast<std::uint32_t>(std::lower_bound(levels.begin(), levels.end(), l) - levels.begin()));
}

}  // namespace

BondModel find_bond_model(const Body& body, double horizon) {
  if (!(horizon >= 1 && horizon <= 20)) throw InputError("the horizon must be from 1 to 20 node spacings");
  const NodeSet& nodes = body.nodes;
  BondModel model;
  set_blocks(nodes, horizon, model);
  std::vector<std::array<Vec3, 3>> soup;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) soup.push_back(body.surface.corners(FaceId(f)));
  const TriangleBvh faces(soup);
  const NodeGrid grid(nodes.spacing[0], nodes.position);
  std::vector<std::vector<std::uint32_t>> kept(nodes.size()), cut(nodes.size());
  parallel_for(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    std::vector<Vec3> ends;
    std::vector<std::uint8_t> blocked;
    for (std::size_t i = begin; i < end; ++i) {
      near.clear();
      ends.clear();
      grid.within(nodes.position, nodes.position[i], model.horizon[model.block[i]], near);
      std::erase(near, static_cast<std::uint32_t>(i));
      for (const auto j : near) ends.push_back(nodes.position[j]);
      blocked.assign(near.size(), 0);
      faces.blocks(nodes.position[i], ends, blocked.data());
      for (std::size_t n = 0; n < near.size(); ++n) (blocked[n] ? cut : kept)[i].push_back(near[n]);
    }
  });
  model.indptr.push_back(0);
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    model.indices.insert(model.indices.end(), kept[i].begin(), kept[i].end());
    model.indptr.push_back(model.indices.size());
    for (const auto j : cut[i]) model.broken.emplace_back(NodeId(std::min(i, j)), NodeId(std::max(i, j)));
  }
  std::sort(model.broken.begin(), model.broken.end());
  model.broken.erase(std::unique(model.broken.begin(), model.broken.end()), model.broken.end());
  return model;
}

}  // namespace geo
