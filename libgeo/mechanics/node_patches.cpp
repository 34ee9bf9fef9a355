#include "mechanics/node_patches.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "mechanics/patch_lanes.h"

namespace geo {
namespace {

constexpr std::size_t most_inside = 6;
constexpr double overlap = 0.9;  // of spacings
constexpr int deepest = 180;     // nodes closer together than this tells apart stay in one box

std::size_t tiles(std::size_t nodes) { return 12 * (nodes * (nodes + 1) / 2); }

// Halves a box, one axis after another, until `most_inside` nodes are left in each part: what it comes to depends on no node outside.
template <class Take>
void divide(const std::vector<Vec3>& position, std::span<std::uint32_t> nodes, const Vec3& middle, const Vec3& half, int depth, const Take& take) {
  if (nodes.empty()) return;
  if (nodes.size() <= most_inside || depth == deepest) return take(nodes);
  const int axis = depth % 3;
  const auto upper = std::partition(nodes.begin(), nodes.end(), [&](auto i) { return position[i][axis] < middle[axis]; });
  const auto below = static_cast<std::size_t>(upper - nodes.begin());
  Vec3 quarter = half;
  quarter[axis] *= 0.5;
  const Vec3 step = quarter[axis] * Vec3::Unit(axis);
  divide(position, nodes.first(below), middle - step, quarter, depth + 1, take);
  divide(position, nodes.subspan(below), middle + step, quarter, depth + 1, take);
}

// The nodes of boxes that hang together.
std::vector<std::vector<std::uint32_t>> boxes(const std::vector<Vec3>& position, const NodeRows& rows) {
  double farthest = 0;
  for (const Vec3& x : position) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  std::vector<std::uint32_t> all(position.size()), box(position.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::span<std::uint32_t>> found;
  divide(position, all, Vec3::Zero(), Vec3::Constant(std::exp2(std::ceil(std::log2(farthest)) + 1)), 0, [&](std::span<std::uint32_t> nodes) {
    for (const auto i : nodes) box[i] = static_cast<std::uint32_t>(found.size());
    found.push_back(nodes);
  });
  std::vector<std::vector<std::vector<std::uint32_t>>> parts(found.size());  // of each box
  std::vector<char> taken(position.size(), 0);
  parallel_for(found.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      std::sort(found[b].begin(), found[b].end());
      for (const auto i : found[b]) {
        if (taken[i]) continue;
        taken[i] = 1;
        auto& part = parts[b].emplace_back(1, i);
        for (std::size_t k = 0; k < part.size(); ++k)
          for (const auto j : rows[part[k]].to)
            if (box[j] == b && !std::exchange(taken[j], 1)) part.push_back(j);
      }
    }
  });
  std::vector<std::vector<std::uint32_t>> all_parts;
  for (auto& of_box : parts) std::move(of_box.begin(), of_box.end(), std::back_inserter(all_parts));
  return all_parts;
}

}  // namespace

NodePatches::NodePatches(const std::vector<Vec3>& position, const NodeRows& rows, const std::vector<double>& spacing, const MaterialPoints& points) {
  list(position, rows, spacing);
  sum_points(points, std::vector<char>(count(), 1));
}

std::vector<std::uint32_t> NodePatches::follow(const std::vector<Vec3>& position, const NodeRows& rows, const std::vector<double>& spacing,
                                               const MaterialPoints& points, const PointChanges& changes) {
  NodePatches before = std::move(*this);
  *this = NodePatches();
  list(position, rows, spacing);
  std::vector<char> wanted(count(), 1);
  std::vector<std::uint32_t> old(count(), ~0u);
  for (std::size_t p = 0; p < count(); ++p) {
    const auto now = nodes(p);
    if (now[0] + 1 >= before.begin_.size() || std::any_of(now.begin(), now.end(), [&](auto i) { return changes.nodes[i]; })) continue;
    for (const Incidence& at : before.patches_of(now[0])) {
      const auto was = before.nodes(at.patch);
      if (before.outer_[at.patch].empty() || !std::equal(now.begin(), now.end(), was.begin(), was.end())) continue;
      outer_[p] = std::move(before.outer_[at.patch]), point_[p] = before.point_[at.patch], wanted[p] = 0, old[p] = at.patch;
      if (point_[p].first != ~0u) point_[p].first = changes.blocks[point_[p].first];
      break;
    }
  }
  sum_points(points, wanted);
  return old;
}

void NodePatches::list(const std::vector<Vec3>& position, const NodeRows& rows, const std::vector<double>& spacing) {
  std::vector<std::vector<std::uint32_t>> inside = boxes(position, rows);
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
  begin_.assign(position.size() + 1, 0);
  for (const auto& nodes : inside) {
    node_.insert(node_.end(), nodes.begin(), nodes.end());
    first_.push_back(node_.size());
    for (const auto i : nodes) ++begin_[i + 1];
  }
  for (std::size_t i = 0; i < position.size(); ++i) begin_[i + 1] += begin_[i];
  at_.resize(node_.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t p = 0; p < inside.size(); ++p)
    for (std::uint32_t s = 0; s < inside[p].size(); ++s) at_[next[inside[p][s]]++] = {p, s};
  outer_.resize(count()), point_.assign(count(), {~0u, 0});
}

// Of the patches wanted: what each block has for them, then the sum over blocks in their order.
void NodePatches::sum_points(const MaterialPoints& points, const std::vector<char>& wanted) {
  std::vector<PatchParts> parts(points.blocks.size());
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      PatchParts& part = parts[b];
      for (const auto j : block.nodes)
        for (const Incidence& at : patches_of(j))
          if (wanted[at.patch]) part.patches.push_back(at.patch);
      if (part.patches.empty()) continue;
      std::sort(part.patches.begin(), part.patches.end());
      part.patches.erase(std::unique(part.patches.begin(), part.patches.end()), part.patches.end());
      part.first.assign(1, 0);
      for (const auto p : part.patches) part.first.push_back(part.first.back() + tiles(nodes(p).size()));
      part.outer.assign(part.first.back(), 0), part.most.assign(part.patches.size(), {0, 0});
      std::vector<std::uint32_t> first(1, 0);
      std::vector<Incidence> places;  // per node of the block: numbers in part.patches, and slots
      for (const auto j : block.nodes) {
        for (const Incidence& at : patches_of(j))
          if (wanted[at.patch])
            places.push_back({static_cast<std::uint32_t>(std::lower_bound(part.patches.begin(), part.patches.end(), at.patch) - part.patches.begin()), at.slot});
        first.push_back(static_cast<std::uint32_t>(places.size()));
      }
      add_outer_products(block, first, places, part);
    }
  });
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> from(count());  // block, and number there
  for (std::uint32_t b = 0; b < parts.size(); ++b)
    for (std::uint32_t k = 0; k < parts[b].patches.size(); ++k) from[parts[b].patches[k]].push_back({b, k});
  parallel_for(count(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (!wanted[p]) continue;
      outer_[p].assign(tiles(nodes(p).size()), 0);
      std::uint32_t most = 0;
      for (const auto& [b, k] : from[p]) {
        const PatchParts& part = parts[b];
        for (std::size_t t = 0; t < outer_[p].size(); ++t) outer_[p][t] += part.outer[part.first[k] + t];
        if (part.most[k].count > most) most = part.most[k].count, point_[p] = {b, part.most[k].point};
      }
      for (std::size_t t = 3; t < outer_[p].size(); t += 4) outer_[p][t] = 0;
    }
  });
}

}  // namespace geo
