// Incremental update: equal cells before and after a cut are matched in Morton order. A point of
// such a cell keeps its shape gradients unless a changed support or face touches what they depend
// on.
#include "mechanics/discretisation/galerkin.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "body/incremental_cache.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/point_supports.h"

namespace geo {
namespace {

constexpr std::size_t max_cells_per_block = 256;  // larger: fewer copies of a node's slots, longer node lists
constexpr std::size_t none = ~std::size_t(0);

// Faces that were added or removed, and supports of nodes that were added, moved or resized.
class Changes {
 public:
  Changes(const std::vector<std::array<Vec3, 3>>& faces, const std::vector<std::pair<Vec3, double>>& supports)
      : faces_(faces), supports_(supports) {
    for (const auto& [a, b, c] : faces) bounds_.add(box_of(a, b, c));
    for (const auto& [x, r] : supports) bounds_.add(Box3{x, x}.grown(support_factors.back() * r));
  }
  /// False if the changes touch no point in the box whose influence radius is at most `radius`.
  bool near(const Box3& points, double radius) const { return points.grown(radius).meets(bounds_); }
  /// Changed supports that may hold a point in the box, widened or not.
  std::vector<std::pair<Vec3, double>> supports(const Box3& points) const {
    std::vector<std::pair<Vec3, double>> near;
    for (const auto& s : supports_)
      if (points.grown(support_factors.back() * s.second).meets({s.first, s.first})) near.push_back(s);
    return near;
  }
  /// True if faces, or `supports`, touch anything that decides the point's shape gradients: the
  /// nodes that support it, the segments to them, the segment from its intended position. For a
  /// point with hidden nodes, whose lines of sight bend round fronts, any changed face in its
  /// neighbourhood counts.
  bool affect(const Body& body, std::span<const std::pair<Vec3, double>> supports, const Vec3& intended,
              const MaterialPoint& p) const {
    const double factor = support_factors[p.widenings];
    if (std::any_of(supports.begin(), supports.end(),
                    [&](const auto& s) { return (s.first - p.position).norm() < factor * s.second; }))
      return true;
    std::vector<std::uint32_t> near;
    faces_.near(Box3{p.position, p.position}.grown(p.influence_radius), near);
    if (near.empty() || p.occluded) return !near.empty();
    // The point sees all nodes that may support it, within its influence radius.
    near.clear();
    body.cache->grid.within(body.nodes.position, p.position,
                            p.influence_radius * (1 + 4 * std::numeric_limits<double>::epsilon()), near);
    std::vector<Vec3> ends{intended};
    for (const auto j : near) ends.push_back(body.nodes.position[j]);
    std::vector<std::uint8_t> touched(ends.size(), 0);
    faces_.blocks(p.position, ends, touched.data());
    return std::find(touched.begin(), touched.end(), 1) != touched.end();
  }

 private:
  TriangleBvh faces_;
  const std::vector<std::pair<Vec3, double>>& supports_;
  Box3 bounds_;
};

// Each point has a quarter of its cell's volume.
void set_volumes(std::span<const QuadratureCell> cells, std::vector<MaterialPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].volume = 0.25 * cells[i / 4].volume, points[i].unscaled_volume = 0.25 * cells[i / 4].unscaled_volume;
}

void set_position(const Body& body, const Vec3& intended, MaterialPoint& point) {
  point.position = moved_off_faces(body, intended), point.influence_radius = (point.position - intended).norm();
}

// Per cell, the index of the same cell before, or ~0u (none). Both lists are in Morton order.
std::vector<std::uint32_t> same_cells(std::span<const QuadratureCell> now, std::span<const QuadratureCell> before) {
  std::vector<std::uint32_t> same;
  std::size_t o = 0;
  for (const QuadratureCell& c : now) {
    while (o < before.size() && morton(before[o].cell.corner) < morton(c.cell.corner)) ++o;
    const bool found =
        o < before.size() && before[o].cell.corner == c.cell.corner && before[o].cell.level == c.cell.level;
    same.push_back(found ? static_cast<std::uint32_t>(o) : ~0u);
  }
  return same;
}

// A block after splits: the source of each point among the old blocks, and the points to recompute.
struct BlockUpdate {
  std::size_t same_block = none;      // the old block with the same cells
  std::vector<MaterialPoint> points;  // empty if nothing has changed
  std::vector<PointBlock::Source> sources;
  std::vector<std::uint32_t> stale;    // points to recompute
  std::vector<ShapeGradients> shapes;  // of these

  BlockUpdate() = default;
  // The old state: blocks, and the first cell of each.
  struct Old {
    std::span<const std::size_t> block_begin;
    std::span<const PointBlock> blocks;
  };
  // `old_cell`: per cell of the block, its old index or ~0u. `radius`: the largest influence
  // radius.
  BlockUpdate(const Body& body, const Changes& changes, double radius, std::span<const QuadratureCell> cells,
              std::span<const std::uint32_t> old_cell, const Old& old) {
    const auto first = old.block_begin;
    const auto block_of = [&](std::uint32_t cell) {
      return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), cell) - first.begin() - 1);
    };
    if (old_cell[0] != ~0u) {
      const std::size_t o = block_of(old_cell[0]);
      bool same = old_cell[0] == first[o] && first[o + 1] - first[o] == cells.size();
      for (std::size_t c = 1; c < cells.size() && same; ++c) same = old_cell[c] == old_cell[0] + c;
      if (same) same_block = o;
    }
    if (same_block != none && !changes.near(old.blocks[same_block].box, radius)) return;
    sources.resize(4 * cells.size());
    Box3 box;
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      if (old_cell[c] == ~0u) continue;
      const std::size_t from = same_block != none ? same_block : block_of(old_cell[c]);
      box.add(old.blocks[from].box);
      for (std::uint32_t i = 0; i < 4; ++i)
        sources[4 * c + i] = {&old.blocks[from], 4 * (old_cell[c] - first[from]) + i};
    }
    const auto supports = changes.supports(box);
    for (std::uint32_t i = 0; i < sources.size(); ++i)
      if (const auto& [block, point, shape] = sources[i];
          !block || changes.affect(body, supports, cells[i / 4].point[i % 4], block->points[point]))
        stale.push_back(i);
    if (same_block != none && stale.empty()) return;
    points.resize(sources.size()), shapes.resize(stale.size());
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (sources[i].block) points[i] = sources[i].block->points[sources[i].point];
    for (const auto i : stale) set_position(body, cells[i / 4].point[i % 4], points[i]);
  }

  // The new block, after compute_supports() of the stale points.
  PointBlock make_block(std::span<const QuadratureCell> cells, std::span<PointBlock> old) {
    if (points.empty()) {
      set_volumes(cells, old[same_block].points);
      return std::move(old[same_block]);
    }
    set_volumes(cells, points);
    for (std::size_t s = 0; s < stale.size(); ++s) sources[stale[s]].shape = &shapes[s];
    return {std::move(points), sources};
  }

  // Records in `changes` what became of the points in the new block `now`, the index of which is
  // `number`.
  void record(std::uint32_t number, const PointBlock& now, std::span<const PointBlock> old,
              PointChanges& changes) const {
    if (same_block == none) {
      for (const auto j : now.nodes) changes.node_changed[j] = 1;
      return;
    }
    changes.new_block[same_block] = number;
    for (const auto i : stale)
      for (const PointBlock* block : {&now, &old[same_block]})
        for (auto q = block->entry_begin[i]; q < block->entry_begin[i + 1]; ++q)
          changes.node_changed[block->nodes[block->entry_node[q]]] = 1;
  }
};

}  // namespace

Galerkin::Galerkin(const Body& body, MaterialPoints& points)
    : cells_(body), block_begin_(cells_.groups(max_cells_per_block)) {
  const Occluders occluders = all_occluders(body.surface);
  points.blocks.resize(block_begin_.size() - 1);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto cells = cells_of(b);
      std::vector<MaterialPoint> all(4 * cells.size());
      std::vector<ShapeGradients> shapes(all.size());
      std::vector<SupportTask> tasks;
      for (std::size_t i = 0; i < all.size(); ++i)
        set_position(body, cells[i / 4].point[i % 4], all[i]), tasks.push_back({&all[i], &shapes[i]});
      compute_supports(body, std::move(tasks), &occluders);
      set_volumes(cells, all);
      points.blocks[b] = PointBlock(std::move(all), shapes);
    }
  });
  points.number_points(body.nodes.size());
}

void Galerkin::mark_changed(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position) {
  const NodeSet& nodes = body.nodes;
  for (const auto* list : {&delta.crack.new_faces, &delta.crack.removed_faces})
    for (const FaceId f : *list) faces_.push_back(body.surface.corners(f));
  for (std::size_t i = delta.first_new_node.index(); i < nodes.size(); ++i)
    supports_.push_back({nodes.position[i], nodes.radius[i]});
  for (std::size_t k = 0; k < delta.moved_nodes.size(); ++k) {
    const std::size_t i = delta.moved_nodes[k].index();
    supports_.push_back({old_position[k], nodes.radius[i]}), supports_.push_back({nodes.position[i], nodes.radius[i]});
  }
  for (const auto& [i, before] : delta.resized_nodes)
    supports_.push_back({nodes.position[i.index()], std::max(before, nodes.radius[i.index()])});
}

PointChanges Galerkin::rebuild_changed(const Body& body, MaterialPoints& points) {
  PointChanges result;
  const auto old_block_begin = block_begin_;
  std::vector<std::uint32_t> old_cell(cells_.cells().size());  // per cell: its old index, or ~0u
  std::iota(old_cell.begin(), old_cell.end(), 0);
  if (!supports_.empty()) {
    const auto before = cells_.cells();
    if (cells_.update(body)) {
      old_cell = same_cells(cells_.cells(), before);
      block_begin_ = cells_.groups(max_cells_per_block);
      for (const auto c : old_cell)
        for (std::uint32_t k = 0; k < 4; ++k) result.old_point.push_back(c == ~0u ? c : 4 * c + k);
    }
  }
  const Changes changes(faces_, supports_);
  std::vector<PointBlock> old(block_begin_.size() - 1);
  old.swap(points.blocks);
  std::vector<BlockUpdate> updates(points.blocks.size());
  const double radius = support_factors.back() * *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  parallel_for(updates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      updates[b] = BlockUpdate(body, changes, radius, cells_of(b), {&old_cell[block_begin_[b]], cells_of(b).size()},
                               {old_block_begin, old});
  });
  std::vector<SupportTask> tasks;
  for (BlockUpdate& r : updates)
    for (std::size_t s = 0; s < r.stale.size(); ++s) tasks.push_back({&r.points[r.stale[s]], &r.shapes[s]});
  compute_supports(body, std::move(tasks));
  parallel_for(updates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) points.blocks[b] = updates[b].make_block(cells_of(b), old);
  });
  points.number_points(body.nodes.size());
  result.node_changed.assign(body.nodes.size(), 0), result.new_block.assign(old.size(), ~0u);
  for (std::uint32_t b = 0; b < updates.size(); ++b) updates[b].record(b, points.blocks[b], old, result);
  for (std::size_t o = 0; o < old.size(); ++o)
    if (result.new_block[o] == ~0u)
      for (const auto j : old[o].nodes) result.node_changed[j] = 1;
  faces_.clear(), supports_.clear();
  return result;
}

}  // namespace geo
