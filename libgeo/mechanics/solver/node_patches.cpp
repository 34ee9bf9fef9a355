#include "mechanics/solver/node_patches.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "kerf/parallel.h"
#include "mechanics/solver/patch_lanes.h"

namespace geo {
namespace {

constexpr std::size_t most_inside = 6;
constexpr double overlap = 0.9;  // of spacings
constexpr int deepest = 180;     // nodes closer together than this tells apart stay in one box

std::size_t tiles(std::size_t nodes) { return 12 * (nodes * (nodes + 1) / 2); }

using Boxes = std::vector<std::span<std::uint32_t>>;  // the nodes of each

// Halves a box, one axis after another, until `most_inside` nodes are left in each part: what it
// comes to depends on no node outside.
void divide(const std::vector<Vec3>& position, std::span<std::uint32_t> nodes, const Vec3& middle, const Vec3& half,
            int depth, Boxes& found) {
  constexpr std::size_t many = 2048;
  if (nodes.empty()) return;
  if (nodes.size() <= most_inside || depth == deepest) return found.push_back(nodes);
  const int axis = depth % 3;
  const auto upper =
      std::partition(nodes.begin(), nodes.end(), [&](auto i) { return position[i][axis] < middle[axis]; });
  const auto below = static_cast<std::size_t>(upper - nodes.begin());
  Vec3 quarter = half;
  quarter[axis] *= 0.5;
  const Vec3 step = quarter[axis] * Vec3::Unit(axis);
  const auto divide_lower = [&](Boxes& out) {
    divide(position, nodes.first(below), middle - step, quarter, depth + 1, out);
  };
  const auto divide_upper = [&](Boxes& out) {
    divide(position, nodes.subspan(below), middle + step, quarter, depth + 1, out);
  };
  if (nodes.size() < many) return divide_lower(found), divide_upper(found);
  Boxes above;
  parallel_invoke([&] { divide_lower(found); }, [&] { divide_upper(above); });
  found.insert(found.end(), above.begin(), above.end());
}

// Halves of halves of a cube about the origin, which holds all.
Boxes boxes_of(const std::vector<Vec3>& position, std::span<std::uint32_t> nodes) {
  double farthest = 0;
  for (const Vec3& x : position) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  Boxes found;
  divide(position, nodes, Vec3::Zero(), Vec3::Constant(std::exp2(std::ceil(std::log2(farthest)) + 1)), 0, found);
  return found;
}

// What hangs together in a box, each with its neighbours. `nodes`: the box's, ascending; `box`: per
// node, its number; `taken`: per node, 0 before, 1 then.
std::vector<std::vector<std::uint32_t>> patches_in(std::span<const std::uint32_t> nodes,
                                                   const std::vector<std::uint32_t>& box,
                                                   const NodalGradientOperator& rows,
                                                   const std::vector<double>& spacing, std::vector<char>& taken) {
  std::vector<std::vector<std::uint32_t>> patches;
  std::vector<std::uint32_t> own;
  for (const auto i : nodes) {
    if (taken[i]) continue;
    taken[i] = 1, own.assign(1, i);
    for (std::size_t k = 0; k < own.size(); ++k)
      for (const auto j : rows[own[k]].neighbors)
        if (box[j] == box[i] && !std::exchange(taken[j], 1)) own.push_back(j);
    auto& patch = patches.emplace_back(own);
    for (const auto o : own)
      for (std::size_t q = 0; q < rows[o].neighbors.size(); ++q)
        if (const auto j = rows[o].neighbors[q]; rows[o].offset[q].norm() < overlap * std::min(spacing[o], spacing[j]))
          patch.push_back(j);
    std::sort(patch.begin(), patch.end());
    patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
  }
  return patches;
}

}  // namespace

NodePatches::NodePatches(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
                         const std::vector<double>& spacing, const MaterialPoints& points) {
  list(position, rows, spacing);
  sum_points(points, std::vector<char>(count(), 1));
}

std::vector<std::uint32_t> NodePatches::follow(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
                                               const std::vector<double>& spacing, const std::vector<char>& other,
                                               const MaterialPoints& points, const PointChanges& changes) {
  NodePatches before = std::move(*this);
  *this = NodePatches();
  list(position, rows, spacing, &before, &other);
  std::vector<char> wanted(count(), 1);
  std::vector<std::uint32_t> old(count(), ~0u);
  for (std::size_t p = 0; p < count(); ++p) {
    const auto now = nodes(p);
    if (now[0] + 1 >= before.begin_.size() ||
        std::any_of(now.begin(), now.end(), [&](auto i) { return changes.node_changed[i]; }))
      continue;
    for (const Incidence& at : before.patches_of(now[0])) {
      const auto was = before.nodes(at.patch);
      if (before.outer_[at.patch].empty() || !std::equal(now.begin(), now.end(), was.begin(), was.end())) continue;
      outer_[p] = std::move(before.outer_[at.patch]), point_[p] = before.point_[at.patch], wanted[p] = 0,
      old[p] = at.patch;
      if (point_[p].first != ~0u) point_[p].first = changes.new_block[point_[p].first];
      break;
    }
  }
  sum_points(points, wanted);
  return old;
}

void NodePatches::list(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
                       const std::vector<double>& spacing, const NodePatches* before, const std::vector<char>* other) {
  std::vector<std::uint32_t> all(position.size());
  std::iota(all.begin(), all.end(), 0);
  const Boxes boxes = boxes_of(position, all);
  box_.resize(position.size());
  for (std::uint32_t b = 0; b < boxes.size(); ++b)
    for (const auto i : boxes[b]) box_[i] = b;
  std::vector<std::uint32_t> size_before(before ? before->first_patch_.size() : 0, 0);  // of each box
  if (before)
    for (const auto b : before->box_) ++size_before[b];
  // A box of the same nodes, of which none is another, has the patches that it had.
  const auto same = [&](std::span<const std::uint32_t> nodes) {
    if (!before || nodes[0] >= before->box_.size() || size_before[before->box_[nodes[0]]] != nodes.size()) return false;
    return std::all_of(nodes.begin(), nodes.end(), [&](auto i) {
      return i < before->box_.size() && before->box_[i] == before->box_[nodes[0]] && !(*other)[i];
    });
  };
  std::vector<std::vector<std::vector<std::uint32_t>>> patches(boxes.size());  // of each box
  std::vector<char> taken(position.size(), 0);
  parallel_for(boxes.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (same(boxes[b])) {
        const auto was = before->box_[boxes[b][0]];
        for (auto p = before->first_patch_[was]; p < before->first_patch_[was + 1]; ++p)
          patches[b].emplace_back(before->nodes(p).begin(), before->nodes(p).end());
      } else {
        std::sort(boxes[b].begin(), boxes[b].end());
        patches[b] = patches_in(boxes[b], box_, rows, spacing, taken);
      }
    }
  });
  std::vector<std::vector<std::uint32_t>> inside;  // of each patch
  for (auto& of_box : patches) {
    first_patch_.push_back(static_cast<std::uint32_t>(inside.size()));
    std::move(of_box.begin(), of_box.end(), std::back_inserter(inside));
  }
  first_patch_.push_back(static_cast<std::uint32_t>(inside.size()));
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
            places.push_back(
                {static_cast<std::uint32_t>(std::lower_bound(part.patches.begin(), part.patches.end(), at.patch) -
                                            part.patches.begin()),
                 at.slot});
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
