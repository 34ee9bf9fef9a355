#include "sampling/sample.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "geometry/bvh.h"
#include "sampling/node_grid.h"
#include "sampling/octree.h"
#include "sampling/signed_distance.h"

namespace geo {
namespace {

constexpr int across = 4;            // sample points across a cell
constexpr double least_share = 0.1;  // a cell with less material than this gives it to its neighbours
constexpr double keep_off = 0.12;    // a node stays this fraction of its cell away from the surface where it can

struct Candidate {
  Vec3 position = Vec3::Zero();
  double share = 0;  // of the cell that is material
  bool inside = false;
};

Candidate place(const Cell& cell, const Vec3& origin, double size, const SignedDistance& distance, const TriangleBvh& tree, const SampleOptions& options) {
  const double edge = size * double(1 << cell.level);
  const Vec3 corner = origin + size * Vec3(cell.corner[0], cell.corner[1], cell.corner[2]);
  Candidate c;
  Vec3 sum = Vec3::Zero(), deepest = Vec3::Zero();
  double most = 0;
  int count = 0;
  for (int i = 0; i < across * across * across; ++i) {
    const Vec3 p = corner + edge / across * (Vec3(i % across, i / across % across, i / (across * across)) + Vec3::Constant(0.5));
    const double depth = -distance.at(p);
    if (depth <= 0) continue;
    sum += p;
    ++count;
    if (depth > most) most = depth, deepest = p;
  }
  if (count == 0) return c;
  c.share = double(count) / (across * across * across);
  Random random(options.seed ^ (std::uint64_t(cell.corner[0]) << 42 ^ std::uint64_t(cell.corner[1]) << 21 ^ std::uint64_t(cell.corner[2])) * 0x9e3779b97f4a7c15ull);
  Vec3 shift;
  for (int k = 0; k < 3; ++k) shift[k] = options.jitter * edge * random.uniform(-1, 1);
  // A whole cell's node is jittered about its middle; a cut cell's stands in the middle of its material.
  for (const Vec3& p : {Vec3(sum / count + (count == across * across * across ? shift : Vec3(0.3 * shift))), Vec3(sum / count), deepest}) {
    c.position = p;
    const auto close = tree.closest(p, keep_off * edge);
    if (close.row != ~0u) {
      if (close.distance == 0) continue;
      Vec3 away = (p - close.point) / close.distance;
      if (!tree.inside(p)) continue;
      const Vec3 pushed = close.point + keep_off * edge * away;
      if (tree.closest(pushed, 0.5 * keep_off * edge).row == ~0u && tree.inside(pushed)) c.position = pushed;
    }
    if (tree.inside(c.position)) {
      c.inside = true;
      return c;
    }
  }
  return c;
}

NodeSet sample_at(const TriangleMesh& solid, const TriangleBvh& tree, double size, const SampleOptions& options, const Progress& progress) {
  report(progress, "distance field", 0, 1);
  const SignedDistance distance(solid, 0.5 * size);
  Box3 box = bounding_box(solid);
  box = box.grown(0.01 * size);
  // The finest cells are centred on the body, so that a symmetric model is sampled symmetrically.
  const double coarse = size * double(1 << (options.levels - 1));
  for (int i = 0; i < 3; ++i) {
    const double rest = std::ceil((box.hi[i] - box.lo[i]) / coarse) * coarse - (box.hi[i] - box.lo[i]);
    box.lo[i] -= 0.5 * rest, box.hi[i] += 0.5 * rest;
  }
  const auto cells = build_octree(box, size, options.levels, [&](const Vec3& p) { return -distance.at(p); });
  report(progress, "nodes", 0, cells.size());
  std::vector<Candidate> candidates(cells.size());
  parallel_for(cells.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) candidates[i] = place(cells[i], box.lo, size, distance, tree, options);
  });

  NodeSet nodes;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& c = candidates[i];
    if (!c.inside || c.share < least_share) continue;
    const double edge = size * double(1 << cells[i].level);
    nodes.position.push_back(c.position);
    nodes.spacing.push_back(edge);
    nodes.volume.push_back(c.share * edge * edge * edge);
  }
  if (nodes.size() == 0) return nodes;
  // Material of cells without a node goes to the nearest node; then all volumes are scaled to the body's.
  const NodeGrid grid(1.5 * size, nodes.position);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& c = candidates[i];
    if ((c.inside && c.share >= least_share) || c.share == 0) continue;
    const double edge = size * double(1 << cells[i].level);
    const Vec3 middle = box.lo + size * Vec3(cells[i].corner[0], cells[i].corner[1], cells[i].corner[2]) + Vec3::Constant(0.5 * edge);
    const auto nearest = grid.nearest(nodes.position, middle, 1, ~0u, [](auto) { return true; });
    nodes.volume[nearest[0]] += c.share * edge * edge * edge;
  }
  const double wanted = signed_volume(solid), have = std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0);
  for (double& v : nodes.volume) v *= wanted / have;
  nodes.radius.resize(nodes.size());
  parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Wide enough for a dozen others: fewer seldom span all directions.
      const auto near = grid.nearest(nodes.position, nodes.position[i], 12, static_cast<std::uint32_t>(i), [](auto) { return true; });
      const double reach = near.empty() ? 0 : (nodes.position[near.back()] - nodes.position[i]).norm();
      nodes.radius[i] = std::max(options.support * nodes.spacing[i], 1.05 * std::min(reach, 3 * nodes.spacing[i]));
    }
  });
  return nodes;
}

}  // namespace

NodeSet sample_nodes(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress) {
  const Box3 box = bounding_box(solid);
  if (options.levels < 1 || options.levels > 10) throw InputError("levels must be from 1 to 10");
  if (!(options.spacing >= 0)) throw InputError("the spacing must be positive");
  std::vector<std::array<Vec3, 3>> soup;
  for (const auto& [a, b, c] : solid.triangles) soup.push_back({solid.vertices[a], solid.vertices[b], solid.vertices[c]});
  const TriangleBvh tree(soup);
  const auto limit = [&](double size) {
    if (!(size > box.diagonal() * 1e-4)) throw InputError("the spacing is less than 0.01 % of the model's diagonal; choose a larger one");
  };
  if (options.count == 0) {
    const double size = options.spacing > 0 ? options.spacing : 0.03 * box.diagonal();
    limit(size);
    NodeSet nodes = sample_at(solid, tree, size, options, progress);
    if (nodes.size() == 0) throw InputError("no node fits inside at spacing " + std::to_string(size) + "; choose a smaller one");
    return nodes;
  }
  // More nodes at smaller spacing: bisection on its logarithm.
  const double target = double(options.count), volume = signed_volume(solid);
  double lo = std::cbrt(volume / target) * 0.25, hi = std::cbrt(volume / target) * 2.5;
  NodeSet best;
  double error = 1e300;
  for (int i = 0; i < 24 && error > 0.015 * target; ++i) {
    const double size = std::sqrt(lo * hi);
    limit(size);
    NodeSet nodes = sample_at(solid, tree, size, options, progress);
    const double off = double(nodes.size()) - target;
    if (std::abs(off) < error) error = std::abs(off), best = nodes;
    (off > 0 ? lo : hi) = size;
  }
  if (best.size() == 0) throw InputError("no node fits inside; ask for more nodes");
  return best;
}

}  // namespace geo
