// Each cut cell is sampled at 4³ points with exact inside tests. The share of inside points
// estimates its material, and their mean is the node's position, jittered and then moved off the
// surface.
#include "sampling/leaves.h"

#include "base/random.h"
#include "sampling/walk.h"

namespace geo {
namespace {

constexpr int across = 4;  // sample points across a cell; 4³ = 64 fill one word of region.cpp's bit masks
constexpr int points = across * across * across;

Vec3 random_shift(const Cell& cell, std::uint64_t seed) {
  const auto& c = cell.corner;
  Random random(seed ^
                (std::uint64_t(c[0]) << 42 ^ std::uint64_t(c[1]) << 21 ^ std::uint64_t(c[2])) * 0x9e3779b97f4a7c15ull);
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

/// Moves p to the distance `away` from the closest surface point if it is nearer. It stays where it
/// is if the new point is within away / 2 of the surface or not inside. False if p is not inside.
bool settle(const RegionTree& tree, const Region& region, const Box3& box, double away, Vec3& p) {
  if (!tree.inside(region, p)) return false;
  const auto close = tree.tree().closest(p, away);
  if (close.triangle == ~0u || !(close.distance > 0)) return true;
  const Vec3 pushed = close.point + away / close.distance * (p - close.point);
  if (tree.tree().closest(pushed, 0.5 * away).triangle != ~0u) return true;
  if (box.meets({pushed, pushed}) ? tree.inside(region, pushed) : tree.tree().inside(pushed)) p = pushed;
  return true;
}

Leaf place(const RegionTree& tree, const Lattice& lattice, const Region& region, const Vec3& shift) {
  const double edge = lattice.edge(region.cell.level);
  Leaf leaf{.cell = region.cell, .position = region.probe, .share = 1, .whole = !region.cut(), .node = true};
  if (leaf.whole && shift.cwiseAbs().maxCoeff() <= 0.5 - keep_off) {
    leaf.position += edge * shift;
    return leaf;
  }
  const Box3 box = lattice.box(region.cell);
  Vec3 at[points];
  char in[points];
  for (int i = 0; i < points; ++i)
    at[i] =
        box.lo + edge / across * (Vec3(i % across, i / across % across, i / (across * across)) + Vec3::Constant(0.5));
  tree.inside(region, at, in);
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int i = 0; i < points; ++i)
    if (in[i]) {
      sum += at[i];
      ++count;
    }
  leaf.share = float(count) / points;
  if (count == 0) {
    // A wall between the sample points: it has a node in its middle where it fills most of the
    // cell's cross-section.
    const Wall wall = thinnest_wall(tree, lattice, region, edge);
    if (wall.area < edge * edge || !box.meets({wall.at, wall.at})) return leaf;
    leaf.position = wall.at;
    leaf.node = tree.inside(region, wall.at);
    leaf.share = float(std::max(least_leaf_share, 0.5 * wall.thickness * wall.area / (edge * edge * edge)));
    return leaf;
  }
  const Vec3 middle = sum / count;
  // Where a sample point is outside the material, there is less space: 0.3 of the jitter.
  for (const Vec3& p : {Vec3(middle + (count == points ? 1.0 : 0.3) * edge * shift), middle}) {
    leaf.position = p;
    if (settle(tree, region, box, keep_off * edge, leaf.position)) return leaf;
  }
  // The material is bent or in several parts: the sample point that is deepest in it.
  double most = 0;
  for (int i = 0; i < points; ++i) {
    if (!in[i]) continue;
    const auto close = tree.tree().closest(at[i], edge);
    const double depth = close.triangle == ~0u ? edge : close.distance;
    if (depth > most) {
      most = depth;
      leaf.position = at[i];
    }
  }
  leaf.node = most > 0;
  return leaf;
}

}  // namespace

LeafLists find_leaves(const RegionTree& tree, const OctreeShape& shape, const Divisions& divided,
                      const SampleOptions& options, const Progress& progress) {
  return walk<Leaf>(tree, shape.lattice, {{0, 0, 0}, shape.root}, "nodes", progress,
                    [&](const Region& region, std::vector<Leaf>& found) {
                      if (region.cell.level > shape.top || (region.cell.level > 0 && is_divided(divided, region.cell)))
                        return true;
                      const double spread = options.pattern == NodePattern::grid   ? 0
                                            : options.pattern == NodePattern::blue ? 0.5 - keep_off
                                                                                   : options.jitter;
                      const Leaf leaf =
                          place(tree, shape.lattice, region, spread * random_shift(region.cell, options.seed));
                      if (leaf.share > 0) found.push_back(leaf);
                      return false;
                    });
}

}  // namespace geo
