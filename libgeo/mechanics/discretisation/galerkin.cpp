#include "mechanics/discretisation/galerkin.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "kerf/parallel.h"
#include "mechanics/discretisation/point_rows.h"

namespace geo {
namespace {

constexpr std::size_t cells_a_block = 256;
constexpr std::size_t none = ~std::size_t(0);

// Faces that came or went, and supports of nodes that came, went, moved or changed their radius.
class Changes {
 public:
  Changes(const std::vector<std::array<Vec3, 3>>& faces, const std::vector<std::pair<Vec3, double>>& supports)
      : faces_(faces), supports_(supports) {
    for (const auto& [a, b, c] : faces) where_.add(box_of(a, b, c));
    for (const auto& [x, r] : supports) where_.add(Box3{x, x}.grown(support_growth.back() * r));
  }
  bool near(const Box3& points, double reach) const { return points.grown(reach).meets(where_); }
  /// Supports that may hold a point in the box, grown or not.
  std::vector<std::pair<Vec3, double>> supports(const Box3& points) const {
    std::vector<std::pair<Vec3, double>> near;
    for (const auto& s : supports_)
      if (points.grown(support_growth.back() * s.second).meets({s.first, s.first})) near.push_back(s);
    return near;
  }
  /// Whether faces, or `supports`, touch what the row of a point is made of: nodes that support it, the segments to
  /// these, the way aside. Where faces hide a node already, how far it is round a front is decided all about the point.
  bool concern(const Body& body, std::span<const std::pair<Vec3, double>> supports, const Vec3& place,
               const MaterialPoint& p) const {
    const double grown = support_growth[p.growth];
    if (std::any_of(supports.begin(), supports.end(),
                    [&](const auto& s) { return (s.first - p.position).norm() < grown * s.second; }))
      return true;
    std::vector<std::uint32_t> near;
    faces_.near(Box3{p.position, p.position}.grown(p.reach), near);
    if (near.empty() || p.blinded) return !near.empty();
    // All that may support it are seen, and none is farther away than its reach.
    near.clear();
    body.grid.within(body.nodes.position, p.position, p.reach * (1 + 4 * std::numeric_limits<double>::epsilon()), near);
    std::vector<Vec3> ends{place};
    for (const auto j : near) ends.push_back(body.nodes.position[j]);
    std::vector<std::uint8_t> touched(ends.size(), 0);
    faces_.blocks(p.position, ends, touched.data());
    return std::find(touched.begin(), touched.end(), 1) != touched.end();
  }

 private:
  TriangleBvh faces_;
  const std::vector<std::pair<Vec3, double>>& supports_;
  Box3 where_;
};

// A quarter of its cell's each.
void set_volumes(std::span<const QuadratureCell> cells, std::vector<MaterialPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].volume = 0.25 * cells[i / 4].volume, points[i].measured = 0.25 * cells[i / 4].measured;
}

void put(const Body& body, const Vec3& place, MaterialPoint& point) {
  point.position = off_faces(body, place), point.reach = (point.position - place).norm();
}

// For each cell the number of the same one before, or ~0u; both lists are in Morton order.
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

// A block's points after splits: where each is found among the blocks there were, and which need a new row.
struct BlockRepair {
  std::size_t whole = none;           // the block there was, where it had the same cells
  std::vector<MaterialPoint> points;  // empty where nothing has changed
  std::vector<PointBlock::Source> sources;
  std::vector<std::uint32_t> stale;
  std::vector<ShapeRow> rows;  // of these

  BlockRepair() = default;
  // `was`: numbers of the cells before; `first`: of the first cell of each block before.
  BlockRepair(const Body& body, const Changes& changes, double reach, std::span<const QuadratureCell> cells,
              std::span<const std::uint32_t> was, std::span<const std::size_t> first, std::span<const PointBlock> old) {
    const auto block_of = [&](std::uint32_t cell) {
      return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), cell) - first.begin() - 1);
    };
    if (was[0] != ~0u) {
      const std::size_t o = block_of(was[0]);
      bool same = was[0] == first[o] && first[o + 1] - first[o] == cells.size();
      for (std::size_t c = 1; c < cells.size() && same; ++c) same = was[c] == was[0] + c;
      if (same) whole = o;
    }
    if (whole != none && !changes.near(old[whole].box, reach)) return;
    sources.resize(4 * cells.size());
    Box3 box;
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      if (was[c] == ~0u) continue;
      const std::size_t from = whole != none ? whole : block_of(was[c]);
      box.add(old[from].box);
      for (std::uint32_t i = 0; i < 4; ++i) sources[4 * c + i] = {&old[from], 4 * (was[c] - first[from]) + i};
    }
    const auto supports = changes.supports(box);
    for (std::uint32_t i = 0; i < sources.size(); ++i)
      if (const auto& [block, number, row] = sources[i];
          !block || changes.concern(body, supports, cells[i / 4].point[i % 4], block->points[number]))
        stale.push_back(i);
    if (whole != none && stale.empty()) return;
    points.resize(sources.size()), rows.resize(stale.size());
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (sources[i].block) points[i] = sources[i].block->points[sources[i].point];
    for (const auto i : stale) put(body, cells[i / 4].point[i % 4], points[i]);
  }

  PointBlock mend(std::span<const QuadratureCell> cells, std::span<PointBlock> old) {
    if (points.empty()) {
      set_volumes(cells, old[whole].points);
      return std::move(old[whole]);
    }
    set_volumes(cells, points);
    for (std::size_t s = 0; s < stale.size(); ++s) sources[stale[s]].row = &rows[s];
    return {std::move(points), sources};
  }

  // What it did, as the block `now`.
  void tell(std::uint32_t number, const PointBlock& now, std::span<const PointBlock> old, PointChanges& changes) const {
    if (whole == none) {
      for (const auto j : now.nodes) changes.nodes[j] = 1;
      return;
    }
    changes.blocks[whole] = number;
    for (const auto i : stale)
      for (const PointBlock* block : {&now, &old[whole]})
        for (auto q = block->first[i]; q < block->first[i + 1]; ++q) changes.nodes[block->nodes[block->to[q]]] = 1;
  }
};

}  // namespace

Galerkin::Galerkin(const Body& body, MaterialPoints& points) : cells_(body), groups_(cells_.groups(cells_a_block)) {
  const Obstacles obstacles = all_obstacles(body.surface);
  points.blocks.resize(groups_.size() - 1);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto cells = group(b);
      std::vector<MaterialPoint> all(4 * cells.size());
      std::vector<ShapeRow> rows(all.size());
      std::vector<RowJob> jobs;
      for (std::size_t i = 0; i < all.size(); ++i)
        put(body, cells[i / 4].point[i % 4], all[i]), jobs.push_back({&all[i], &rows[i]});
      build_rows(body, std::move(jobs), &obstacles);
      set_volumes(cells, all);
      points.blocks[b] = PointBlock(std::move(all), rows);
    }
  });
  points.connect(body.nodes.size());
}

void Galerkin::note(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position) {
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

PointChanges Galerkin::settle(const Body& body, MaterialPoints& points) {
  PointChanges found;
  const auto groups_before = groups_;
  std::vector<std::uint32_t> was(cells_.cells().size());  // per cell: its number before
  std::iota(was.begin(), was.end(), 0);
  if (!supports_.empty()) {
    const auto before = cells_.cells();
    if (cells_.follow(body)) {
      was = same_cells(cells_.cells(), before);
      groups_ = cells_.groups(cells_a_block);
      for (const auto c : was)
        for (std::uint32_t k = 0; k < 4; ++k) found.kept.push_back(c == ~0u ? c : 4 * c + k);
    }
  }
  const Changes changes(faces_, supports_);
  std::vector<PointBlock> old(groups_.size() - 1);
  old.swap(points.blocks);
  std::vector<BlockRepair> repairs(points.blocks.size());
  const double reach = support_growth.back() * *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  parallel_for(repairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      repairs[b] = BlockRepair(body, changes, reach, group(b), {&was[groups_[b]], group(b).size()}, groups_before, old);
  });
  std::vector<RowJob> jobs;
  for (BlockRepair& r : repairs)
    for (std::size_t s = 0; s < r.stale.size(); ++s) jobs.push_back({&r.points[r.stale[s]], &r.rows[s]});
  build_rows(body, std::move(jobs));
  parallel_for(repairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) points.blocks[b] = repairs[b].mend(group(b), old);
  });
  points.connect(body.nodes.size());
  found.nodes.assign(body.nodes.size(), 0), found.blocks.assign(old.size(), ~0u);
  for (std::uint32_t b = 0; b < repairs.size(); ++b) repairs[b].tell(b, points.blocks[b], old, found);
  for (std::size_t o = 0; o < old.size(); ++o)
    if (found.blocks[o] == ~0u)
      for (const auto j : old[o].nodes) found.nodes[j] = 1;
  faces_.clear(), supports_.clear();
  return found;
}

}  // namespace geo
