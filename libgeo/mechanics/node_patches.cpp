#include "mechanics/node_patches.h"

#include <algorithm>

#include "base/parallel.h"
#include "mechanics/patch_lanes.h"

namespace geo {
namespace {

constexpr std::size_t most_inside = 6;
constexpr double overlap = 0.9;  // of spacings

std::size_t tiles(std::size_t nodes) { return 12 * (nodes * (nodes + 1) / 2); }

}  // namespace

NodePatches::NodePatches(const std::vector<Vec3>& position, const NodeRows& rows, const std::vector<std::uint32_t>& part, std::uint32_t parts,
                         const std::vector<double>& spacing, const MaterialPoints& points) {
  const NodeGroups groups(position, rows, part, parts, most_inside, position.size());
  std::vector<std::vector<std::uint32_t>> inside(groups.count());
  for (std::uint32_t i = 0; i < position.size(); ++i) inside[groups.of[i]].push_back(i);
  parallel_for(inside.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::vector<std::uint32_t> own = inside[p];
      for (const auto i : own)
        for (std::size_t q = 0; q < rows[i].to.size(); ++q)
          if (const auto j = rows[i].to[q]; rows[i].x[q].norm() < overlap * std::min(spacing[i], spacing[j])) inside[p].push_back(j);
      std::sort(inside[p].begin(), inside[p].end());
      inside[p].erase(std::unique(inside[p].begin(), inside[p].end()), inside[p].end());
    }
  });
  begin_.assign(position.size() + 1, 0), tiles_.assign(1, 0);
  for (const auto& nodes : inside) {
    node_.insert(node_.end(), nodes.begin(), nodes.end());
    first_.push_back(node_.size()), tiles_.push_back(tiles_.back() + tiles(nodes.size()));
    for (const auto i : nodes) ++begin_[i + 1];
  }
  for (std::size_t i = 0; i < position.size(); ++i) begin_[i + 1] += begin_[i];
  at_.resize(node_.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t p = 0; p < inside.size(); ++p)
    for (std::uint32_t s = 0; s < inside[p].size(); ++s) at_[next[inside[p][s]]++] = {p, s};
  sum_points(points);
}

// What each block has for the patches of its nodes, then the sum over blocks in their order.
void NodePatches::sum_points(const MaterialPoints& points) {
  std::vector<PatchParts> parts(points.blocks.size());
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      PatchParts& part = parts[b];
      for (const auto j : block.nodes)
        for (const Incidence& at : patches_of(j)) part.patches.push_back(at.patch);
      std::sort(part.patches.begin(), part.patches.end());
      part.patches.erase(std::unique(part.patches.begin(), part.patches.end()), part.patches.end());
      part.first.assign(1, 0);
      for (const auto p : part.patches) part.first.push_back(part.first.back() + tiles(nodes(p).size()));
      part.outer.assign(part.first.back(), 0), part.most.assign(part.patches.size(), {0, 0});
      std::vector<std::uint32_t> first(1, 0);
      std::vector<Incidence> places;  // per node of the block: numbers in part.patches, and slots
      for (const auto j : block.nodes) {
        for (const Incidence& at : patches_of(j))
          places.push_back({static_cast<std::uint32_t>(std::lower_bound(part.patches.begin(), part.patches.end(), at.patch) - part.patches.begin()), at.slot});
        first.push_back(static_cast<std::uint32_t>(places.size()));
      }
      add_outer_products(block, first, places, part);
    }
  });
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> from(count());  // block, and number there
  for (std::uint32_t b = 0; b < parts.size(); ++b)
    for (std::uint32_t k = 0; k < parts[b].patches.size(); ++k) from[parts[b].patches[k]].push_back({b, k});
  outer_.assign(tiles_.back(), 0), point_.assign(count(), {~0u, 0});
  parallel_for(count(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      std::uint32_t most = 0;
      for (const auto& [b, k] : from[p]) {
        const PatchParts& part = parts[b];
        for (std::size_t t = 0; t < tiles_[p + 1] - tiles_[p]; ++t) outer_[tiles_[p] + t] += part.outer[part.first[k] + t];
        if (part.most[k].count > most) most = part.most[k].count, point_[p] = {b, part.most[k].point};
      }
    }
  });
}

}  // namespace geo
