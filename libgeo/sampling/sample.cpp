// sample_nodes() of kerf/nodes.h. Octree leaves with material become nodes (Pauly et al. 2005): one
// node a leaf, with the leaf's edge as spacing and its share of material as volume. Volumes sum to
// the solid's.
#include "kerf/nodes.h"

#include <cmath>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "sampling/blue_noise.h"
#include "sampling/count.h"
#include "sampling/support.h"

namespace geo {
namespace {

/// Volume of leaves without a node goes to the nearest node. Volumes of whole leaves are exact.
/// Volumes of cut leaves are estimates. They are scaled by (V − Σ whole) / Σ cut, so that the sum
/// is the body's volume V.
void share_volume(NodeSet& nodes, const LeafIndex& index, const Lattice& lattice, const std::vector<char>& whole,
                  const std::vector<Leaf>& orphans, double volume) {
  double exact = 0, estimate = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) (whole[i] ? exact : estimate) += nodes.volume[i];
  const auto volume_of = [&](const Leaf& leaf) {
    const double edge = lattice.edge(leaf.cell.level);
    return leaf.share * (edge * edge * edge);
  };
  for (const Leaf& leaf : orphans) estimate += volume_of(leaf);
  const bool cut_only = estimate > 0 && exact < volume;
  const double scale = cut_only ? (volume - exact) / estimate : volume / (exact + estimate);
  std::vector<std::uint32_t> heir(orphans.size());
  parallel_for(orphans.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 middle = lattice.middle(orphans[k].cell);
      double best = std::numeric_limits<double>::infinity();
      for (int level = orphans[k].cell.level + 1; best == std::numeric_limits<double>::infinity(); ++level)
        index.around(orphans[k].cell, level, [&](std::uint32_t row) {
          const double d = (nodes.position[row] - middle).squaredNorm();
          if (d < best || (d == best && row < heir[k])) {
            best = d;
            heir[k] = row;
          }
        });
    }
  });
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!cut_only || !whole[i]) nodes.volume[i] *= scale;
  for (std::size_t k = 0; k < orphans.size(); ++k) nodes.volume[heir[k]] += scale * volume_of(orphans[k]);
}

NodeSet gather(LeafLists lists, const Lattice& lattice, const NodeSelection& selected, double volume,
               const SampleOptions& options, const Progress& progress, SampleReport& found) {
  Stopwatch clock;
  std::vector<std::size_t> first(lists.size() + 1, 0);
  std::vector<Leaf> orphans;
  for (std::size_t l = 0; l < lists.size(); ++l) {
    first[l + 1] = first[l];
    for (const Leaf& leaf : lists[l]) selected(leaf) ? void(++first[l + 1]) : orphans.push_back(leaf);
  }
  const std::size_t n = first.back();
  NodeSet nodes;
  if (n == 0) return nodes;
  if (n >= ~0u) throw InputError("more than four thousand million nodes; choose a larger spacing");
  nodes.position.resize(n);
  nodes.spacing.resize(n);
  nodes.volume.resize(n);
  std::vector<std::uint64_t> codes(n);
  std::vector<std::uint8_t> levels(n);
  std::vector<char> whole(n);
  parallel_for(lists.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) {
      std::size_t i = first[l];
      for (const Leaf& leaf : lists[l]) {
        if (!selected(leaf)) continue;
        const double edge = lattice.edge(leaf.cell.level);
        nodes.position[i] = leaf.position;
        nodes.spacing[i] = edge;
        nodes.volume[i] = leaf.share * edge * edge * edge;
        codes[i] = morton(leaf.cell.corner);
        levels[i] = static_cast<std::uint8_t>(leaf.cell.level);
        whole[i] = leaf.whole;
        ++i;
      }
      std::vector<Leaf>().swap(lists[l]);
    }
  });
  const LeafIndex index(std::move(codes), std::move(levels));
  share_volume(nodes, index, lattice, whole, orphans, volume);
  if (options.pattern == NodePattern::blue) move_apart(nodes, index, lattice, whole, progress);
  found.node_seconds += clock.lap();
  set_support_radii(nodes, index, options.support, progress);
  found.support_seconds += clock.lap();
  return nodes;
}

}  // namespace

NodeSet sample_nodes(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress,
                     SampleReport* report) {
  const double diagonal = bounding_box(solid).diagonal(), volume = signed_volume(solid);
  if (options.levels < 1 || options.levels > 10) throw InputError("levels must be from 1 to 10");
  if (!(options.spacing >= 0)) throw InputError("the spacing must be positive");
  if (!(options.jitter >= 0 && options.jitter <= 0.5)) throw InputError("the jitter must be from 0 to 0.5");
  if (!(options.support > 0)) throw InputError("the support must be positive");
  if (options.across < 0 || options.across > 100) throw InputError("nodes across thin material must be from 0 to 100");
  const LeafFinder finder(solid, options, progress);
  SampleReport found;
  SpacedLeaves leaves;
  if (options.count > 0) {
    leaves = finder.with_count(options.count, volume, found);
  } else {
    const double spacing = options.spacing > 0 ? options.spacing : 0.03 * diagonal;
    leaves = finder.at(spacing, finder.thin_levels(), ~std::size_t(0), found).value();
  }
  const NodeSet nodes =
      gather(std::move(leaves.lists), leaves.lattice, leaves.selection, volume, options, progress, found);
  if (nodes.size() == 0)
    throw InputError("no node fits inside at spacing " + std::to_string(found.spacing) + "; choose a smaller one");
  const auto copy_wall = [](const Wall& wall, double& thickness, Vec3& at) {
    thickness = std::isfinite(wall.thickness) ? wall.thickness : 0;
    at = wall.at;
  };
  copy_wall(leaves.thin.thinnest, found.thinnest, found.thinnest_at);
  copy_wall(leaves.thin.unresolved, found.unresolved, found.unresolved_at);
  if (report) *report = found;
  return nodes;
}

}  // namespace geo
