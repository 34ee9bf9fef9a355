// Incremental update: equal cells before and after a cut are matched in Morton order. A point of
// such a cell keeps its shape gradients unless a changed support or face touches what they depend
// on: supports, lines of sight, and the paths round fronts that diffraction.h admits.
#include "mechanics/discretisation/galerkin.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "body/incremental_cache.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/point_supports.h"

namespace geo {
namespace {

// Larger: fewer copies of a node's slots, but longer node lists. Small bodies have small blocks: a
// cut computes few of them anew, and threads share them evenly.
std::size_t cells_per_block(const Body& body) { return body.original_nodes < 1024 ? 64 : 256; }
constexpr std::size_t none = ~std::size_t(0);

// Faces that were added or removed, and supports of nodes that were added, moved or resized.
class Changes {
 public:
  Changes(const std::vector<std::array<Vec3, 3>>& faces, const std::vector<std::pair<Vec3, double>>& supports,
          std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> component)
      : visibility_(faces, nodes, component.size()), supports_(supports), component_(component) {
    for (const auto& [a, b, c] : faces) bounds_.add(box_of(a, b, c));
    for (const auto& [x, r] : supports) bounds_.add(Box3{x, x}.grown(support_factors.back() * r));
  }
  /// False if the changes touch no point in the box whose influence radius is at most `radius`.
  bool near(const Box3& points, double radius) const { return points.grown(radius).meets(bounds_); }
  /// Changed supports that may hold a point in the box, widened or not, and faces that lines of
  /// sight of such a point may touch, bent ones included.
  struct Local {
    std::vector<std::pair<Vec3, double>> supports;
    std::vector<std::uint32_t> faces;
    bool empty() const { return supports.empty() && faces.empty(); }
  };
  /// The changes near a box of points. `radius`: their largest influence radius.
  Local local(const Box3& points, double radius) const {
    Local near;
    for (const auto& s : supports_)
      if (points.grown(support_factors.back() * s.second).meets({s.first, s.first})) near.supports.push_back(s);
    visibility_.faces_near(points, radius, near.faces);
    return near;
  }
  /// For compute_supports().
  const VisibilityChanges& visibility() const { return visibility_; }
  /// True if `local` changes touch anything that decides a point's shape gradients: the nodes that
  /// support it, the segments and bent paths to them, the segment from its intended position.
  /// `nodes_near`: returns all nodes that may support the point, and others.
  template <class NodesNear>
  bool affect(const Body& body, const Local& local, const Vec3& intended, const PointBlock& block, std::size_t point,
              const NodesNear& nodes_near) const {
    const MaterialPoint& p = block.points[point];
    const double factor = support_factors[p.widenings];
    if (std::any_of(local.supports.begin(), local.supports.end(),
                    [&](const auto& s) { return (s.first - p.position).norm() < factor * s.second; }))
      return true;
    const std::vector<std::uint32_t> near = visibility_.faces_near(p.position, p.influence_radius, local.faces);
    if (near.empty()) return false;
    std::vector<Vec3> ends{intended};
    for (auto q = block.entry_begin[point]; q < block.entry_begin[point + 1]; ++q)
      ends.push_back(body.nodes.position[block.nodes[block.entry_node[q]]]);
    if (is_touched(p.position, ends)) return true;
    // A point that is not occluded sees all nodes that support it, and no other support has
    // changed.
    if (!p.occluded) return false;
    std::vector<std::uint32_t> nodes;
    ends.clear();
    for (const auto j : nodes_near())
      if (const Vec3& x = body.nodes.position[j]; (x - p.position).norm() < factor * body.nodes.radius[j]) {
        nodes.push_back(j);
        ends.push_back(x);
      }
    if (is_touched(p.position, ends)) return true;
    forget_settled(block, point, nodes);
    const VisibilityChanges::NearFaces faces = visibility_.seen_from(p.position, near);
    return std::any_of(nodes.begin(), nodes.end(), [&](auto j) {
      return faces.meet_bent_paths(body.nodes.position[j], factor * body.nodes.radius[j]);
    });
  }

 private:
  // Whether a changed face touches a segment from x to one of the ends.
  bool is_touched(const Vec3& x, std::span<const Vec3> ends) const {
    std::vector<std::uint8_t> touched(ends.size(), 0);
    visibility_.faces().blocks(x, ends, touched.data());
    return std::find(touched.begin(), touched.end(), 1) != touched.end();
  }
  // Removes the nodes that a point sees straight ahead, and those without a path to it: unseen
  // before, and in another component than the nodes straight ahead. Precondition: no changed face
  // is between the point and nodes straight ahead.
  void forget_settled(const PointBlock& block, std::size_t point, std::vector<std::uint32_t>& nodes) const {
    enum class Seen { no, straight, bent };
    const auto begin = block.entry_begin[point], end = block.entry_begin[point + 1];
    std::optional<std::uint32_t> own;
    for (auto q = begin; q < end && !own; ++q)
      if (!block.entry_bent[q]) own = component_[block.nodes[block.entry_node[q]]];
    auto q = begin;  // entries and nodes are ascending
    std::erase_if(nodes, [&](auto j) {
      while (q < end && block.nodes[block.entry_node[q]] < j) ++q;
      const bool is_entry = q < end && block.nodes[block.entry_node[q]] == j;
      const Seen seen = !is_entry ? Seen::no : block.entry_bent[q] ? Seen::bent : Seen::straight;
      return seen == Seen::straight || (seen == Seen::no && own && component_[j] != *own);
    });
  }
  VisibilityChanges visibility_;
  const std::vector<std::pair<Vec3, double>>& supports_;
  std::span<const std::uint32_t> component_;  // per node, after the changes
  Box3 bounds_;
};

// Each point has a quarter of its cell's volume.
void set_volumes(std::span<const QuadratureCell> cells, std::vector<MaterialPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].volume = 0.25 * cells[i / 4].volume;
    points[i].unscaled_volume = 0.25 * cells[i / 4].unscaled_volume;
  }
}

void set_position(const Body& body, const Vec3& intended, MaterialPoint& point) {
  point.position = moved_off_faces(body, intended);
  point.influence_radius = (point.position - intended).norm();
}

// Per cell, the index of the same cell before, or ~0u (none). Both lists are in Morton order, then
// by `half`.
std::vector<std::uint32_t> same_cells(std::span<const QuadratureCell> now, std::span<const QuadratureCell> before) {
  std::vector<std::uint32_t> same;
  const auto place = [](const QuadratureCell& q) { return std::pair(morton(q.cell.corner), q.half); };
  std::size_t o = 0;
  for (const QuadratureCell& c : now) {
    while (o < before.size() && place(before[o]) < place(c)) ++o;
    const bool found = o < before.size() && place(before[o]) == place(c) && before[o].cell.level == c.cell.level;
    same.push_back(found ? static_cast<std::uint32_t>(o) : ~0u);
  }
  return same;
}

// A box that holds the points that there were, and bounds of their influence radii and support
// factors.
struct PointGroup {
  explicit PointGroup(std::span<const PointBlock::Source> points) {
    for (const auto& [block, point, shape] : points) {
      if (!block) continue;
      const MaterialPoint& p = block->points[point];
      box.add(p.position);
      radius = std::max(radius, p.influence_radius);
      factor = std::max(factor, support_factors[p.widenings]);
    }
  }
  Box3 box;
  double radius = 0, factor = 1;
};

// A block after splits: the source of each point among the old blocks, and the points to recompute.
struct BlockUpdate {
  std::size_t same_block = none;      // the old block with the same cells
  std::vector<MaterialPoint> points;  // empty if nothing has changed
  std::vector<PointBlock::Source> sources;
  std::vector<std::uint32_t> stale;    // points to recompute
  std::vector<char> keeps_position;    // per stale point: 1 if it is where it is intended, as before
  std::vector<ShapeGradients> shapes;  // of these

  BlockUpdate() = default;
  // The old state: blocks, and the first cell of each.
  struct Old {
    std::span<const std::size_t> block_begin;
    std::span<const PointBlock> blocks;
  };
  // `old_cell`: per cell of the block, its old index or ~0u. `largest_node`: the largest radius of
  // a node.
  BlockUpdate(const Body& body, const Changes& changes, double largest_node, std::span<const QuadratureCell> cells,
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
    if (same_block != none && !changes.near(old.blocks[same_block].box, support_factors.back() * largest_node)) return;
    sources.resize(4 * cells.size());
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      if (old_cell[c] == ~0u) continue;
      const std::size_t from = same_block != none ? same_block : block_of(old_cell[c]);
      for (std::uint32_t i = 0; i < 4; ++i)
        sources[4 * c + i] = {&old.blocks[from], 4 * (old_cell[c] - first[from]) + i};
    }
    constexpr std::size_t points_per_query = 32;  // consecutive points are near each other
    for (std::uint32_t begin = 0; begin < sources.size(); begin += points_per_query) {
      const auto group = std::span(sources).subspan(begin, std::min(points_per_query, sources.size() - begin));
      const PointGroup bounds(group);
      const Changes::Local local = changes.local(bounds.box, bounds.radius);
      std::optional<std::vector<std::uint32_t>> nodes;
      const auto nodes_near = [&]() -> const std::vector<std::uint32_t>& {
        return nodes ? *nodes : nodes.emplace(supporting_nodes(body, bounds.box, bounds.factor, largest_node));
      };
      for (std::uint32_t k = 0; k < group.size(); ++k) {
        const auto& [block, point, shape] = group[k];
        const Vec3& intended = cells[(begin + k) / 4].point[k % 4];
        if (block && (local.empty() || !changes.affect(body, local, intended, *block, point, nodes_near))) continue;
        stale.push_back(begin + k);
        // A point on a face sees no node, and may leave the face now.
        keeps_position.push_back(block && block->points[point].position == intended &&
                                 block->entry_begin[point] != block->entry_begin[point + 1] &&
                                 !changes.visibility().may_touch(intended, local.faces));
      }
    }
    if (same_block != none && stale.empty()) return;
    points.resize(sources.size());
    shapes.resize(stale.size());
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (sources[i].block) points[i] = sources[i].block->points[sources[i].point];
    for (std::size_t s = 0; s < stale.size(); ++s) {
      const auto i = stale[s];
      if (keeps_position[s])
        points[i].influence_radius = 0;
      else
        set_position(body, cells[i / 4].point[i % 4], points[i]);
    }
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
  // `number`. `first`: its first point. Uses up `shapes`.
  void record(std::uint32_t number, std::size_t first, const PointBlock& now, std::span<const PointBlock> old,
              PointChanges& changes) {
    for (const auto i : stale) changes.is_stale[first + i] = 1;
    for (std::size_t s = 0; s < stale.size(); ++s)
      if (!shapes[s].value.empty())
        changes.valued.emplace_back(static_cast<std::uint32_t>(first + stale[s]), std::move(shapes[s]));
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

Galerkin::Galerkin(const Body& body, std::span<const std::uint32_t> component, MaterialPoints& points)
    : cells_(body), block_begin_(cells_.groups(cells_per_block(body))) {
  const Occluders occluders = all_occluders(body.surface);
  points.blocks.resize(block_begin_.size() - 1);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto cells = cells_of(b);
      std::vector<MaterialPoint> all(4 * cells.size());
      std::vector<ShapeGradients> shapes(all.size());
      std::vector<SupportTask> tasks;
      for (std::size_t i = 0; i < all.size(); ++i) {
        set_position(body, cells[i / 4].point[i % 4], all[i]);
        tasks.push_back({.point = &all[i], .shape = &shapes[i]});
      }
      compute_supports(body, std::move(tasks), &occluders, nullptr, component);
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
  near_.note_changes(delta.crack.new_faces);
  for (std::size_t i = delta.first_new_node.index(); i < nodes.size(); ++i) {
    supports_.push_back({nodes.position[i], nodes.radius[i]});
    nodes_.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t k = 0; k < delta.moved_nodes.size(); ++k) {
    const std::size_t i = delta.moved_nodes[k].index();
    supports_.push_back({old_position[k], nodes.radius[i]});
    supports_.push_back({nodes.position[i], nodes.radius[i]});
    nodes_.push_back(delta.moved_nodes[k].value);
  }
  for (const auto& [i, before] : delta.resized_nodes) {
    supports_.push_back({nodes.position[i.index()], std::max(before, nodes.radius[i.index()])});
    nodes_.push_back(i.value);
  }
}

PointChanges Galerkin::rebuild_changed(const Body& body, std::span<const std::uint32_t> component,
                                       MaterialPoints& points, const std::function<bool(const Vec3&)>& wants_values) {
  PointChanges result;
  const auto old_block_begin = block_begin_;
  std::vector<std::uint32_t> old_cell(cells_.cells().size());  // per cell: its old index, or ~0u
  std::iota(old_cell.begin(), old_cell.end(), 0);
  if (!supports_.empty()) {
    const auto before = cells_.cells();
    if (cells_.update(body)) {
      old_cell = same_cells(cells_.cells(), before);
      block_begin_ = cells_.groups(cells_per_block(body));
      for (const auto c : old_cell)
        for (std::uint32_t k = 0; k < 4; ++k) result.old_point.push_back(c == ~0u ? c : 4 * c + k);
    }
  }
  const Changes changes(faces_, supports_, nodes_, component);
  std::vector<PointBlock> old(block_begin_.size() - 1);
  old.swap(points.blocks);
  std::vector<BlockUpdate> updates(points.blocks.size());
  const double largest_node = *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  parallel_for(updates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      updates[b] = BlockUpdate(body, changes, largest_node, cells_of(b),
                               {&old_cell[block_begin_[b]], cells_of(b).size()}, {old_block_begin, old});
  });
  std::vector<SupportTask> tasks;
  for (BlockUpdate& r : updates)
    for (std::size_t s = 0; s < r.stale.size(); ++s) {
      const PointBlock::Source& source = r.sources[r.stale[s]];
      MaterialPoint& point = r.points[r.stale[s]];
      tasks.push_back({.point = &point,
                       .shape = &r.shapes[s],
                       .before = source.block,
                       .point_before = source.point,
                       .with_values = wants_values(point.position)});
    }
  compute_supports(body, std::move(tasks), nullptr, &changes.visibility(), component, &near_);
  parallel_for(updates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) points.blocks[b] = updates[b].make_block(cells_of(b), old);
  });
  points.number_points(body.nodes.size());
  result.node_changed.assign(body.nodes.size(), 0);
  result.new_block.assign(old.size(), ~0u);
  result.is_stale.assign(points.size(), 0);
  for (std::uint32_t b = 0; b < updates.size(); ++b)
    updates[b].record(b, points.first_point(b), points.blocks[b], old, result);
  for (std::size_t o = 0; o < old.size(); ++o)
    if (result.new_block[o] == ~0u)
      for (const auto j : old[o].nodes) result.node_changed[j] = 1;
  faces_.clear();
  supports_.clear();
  nodes_.clear();
  return result;
}

}  // namespace geo
