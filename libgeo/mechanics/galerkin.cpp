#include "mechanics/galerkin.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "mechanics/bent_paths.h"

namespace geo {
namespace {

constexpr std::size_t cells_a_block = 256;
constexpr std::size_t few = 8;          // a point with fewer nodes, or a worse moment matrix, widens its support
constexpr double ill_conditioned = 500;
constexpr double hopeless = 1e7;        // linear fields would be off by 1e-9 of their size
constexpr std::array growth{1.0, 1.2, 1.44, 1.728, 2.0736};
constexpr double widest = growth.back();

// What the rows of points near each other are made of: the nodes that may reach them, and the faces that may hide these.
class Surroundings {
 public:
  Surroundings(const Body& body, const Box3& points) : body_(body), points_(points) {
    const NodeSet& nodes = body.nodes;
    const double longest = *std::max_element(nodes.radius.begin(), nodes.radius.end());
    body.grid.within(nodes.position, points.center(), 0.5 * (points.hi - points.lo).norm() + widest * longest, near_);
    std::erase_if(near_, [&](auto j) { return !points.grown(widest * nodes.radius[j]).meets({nodes.position[j], nodes.position[j]}); });
    for (const auto j : near_) longest_ = std::max(longest_, nodes.radius[j]);
  }
  const Body& body() const { return body_; }
  /// Nodes whose support, grown so much, holds x: ascending, and where they are.
  void nodes(const Vec3& x, double grown, std::vector<std::uint32_t>& near, std::vector<Vec3>& at) const {
    near.clear(), at.clear();
    for (const auto j : near_)
      if (const Vec3& y = body_.nodes.position[j]; (y - x).norm() < grown * body_.nodes.radius[j]) near.push_back(j), at.push_back(y);
  }
  /// All faces that may lie on ways from points to such nodes, and the fronts that these may lead round.
  struct Obstacles {
    TriangleBvh faces;
    std::vector<FrontEdge> fronts;
  };
  const Obstacles& obstacles(double grown) {
    auto& found = obstacles_[grown > 1];
    if (!found) {
      std::vector<FaceId> ids;
      body_.surface.near(points_.grown(grown > 1 ? widest * longest_ : longest_), ids);
      std::vector<std::array<Vec3, 3>> faces;
      for (const FaceId f : ids) faces.push_back(body_.surface.corners(f));
      found = Obstacles{TriangleBvh(faces), front_edges(body_.surface, ids)};
    }
    return *found;
  }

 private:
  const Body& body_;
  Box3 points_;
  std::vector<std::uint32_t> near_;
  double longest_ = 0;
  std::optional<Obstacles> obstacles_[2];
};

// A point that a face passes through is on neither of its sides: it steps aside, towards the nearest node.
Vec3 off_faces(Surroundings& around, const Vec3& p) {
  const TriangleBvh& faces = around.obstacles(1).faces;
  if (!faces.blocks(p, p)) return p;
  const Body& body = around.body();
  const auto near = body.grid.nearest(body.nodes.position, p, 1, ~0u, [](auto) { return true; })[0];
  const Vec3 way = body.nodes.position[near] - p;
  if (!(way.norm() < widest * body.nodes.radius[near])) return p;
  for (double step = 1e-3; step < 0.5; step *= 4)
    if (const Vec3 aside = p + step * way; !faces.blocks(aside, aside)) return aside;
  return p;
}

ShapeRow build_row(Surroundings& around, const Vec3& place, MaterialPoint& point) {
  const NodeSet& nodes = around.body().nodes;
  const Vec3 x = off_faces(around, place);
  point.position = x, point.reach = (x - place).norm();
  ShapeRow row;
  std::vector<std::uint32_t> near;
  std::vector<Vec3> ends;
  std::vector<Sight> seen;
  std::vector<std::uint8_t> hidden;
  double condition = 0;
  for (std::size_t t = 0;; ++t) {
    const double grown = growth[t];
    seen.clear(), row.to.clear();
    around.nodes(x, grown, near, ends);
    hidden.assign(ends.size(), 0);
    const auto& [faces, fronts] = around.obstacles(grown);
    if (!faces.empty()) faces.blocks(x, ends, hidden.data());
    point.growth = static_cast<std::uint8_t>(t);
    point.blinded = std::find(hidden.begin(), hidden.end(), 1) != hidden.end();
    for (std::size_t q = 0; q < near.size(); ++q) {
      const double reach = grown * nodes.radius[near[q]], straight = (ends[q] - x).norm();
      // No way to the node that is shorter than its support leads farther off than half of both.
      point.reach = std::max(point.reach, hidden[q] ? 0.5 * (straight + reach) : straight);
      const auto node = hidden[q] ? sight_round(x, ends[q], reach, fronts, faces) : sight(x, ends[q], reach);
      if (node) row.to.push_back(near[q]), seen.push_back(*node);
    }
    condition = shape_gradients(x, seen, row.gradient);
    if ((row.to.size() >= few && condition <= ill_conditioned) || t + 1 == growth.size()) break;
  }
  point.rung = condition <= ill_conditioned ? Rung::full : condition <= hopeless ? Rung::regularised : Rung::rigid;
  if (point.rung == Rung::rigid) row.to.clear(), row.gradient.clear();
  return row;
}

// Faces that came or went, and supports of nodes that came, went or moved.
class Changes {
 public:
  Changes(const std::vector<std::array<Vec3, 3>>& faces, const std::vector<std::pair<Vec3, double>>& supports) : faces_(faces), supports_(supports) {
    for (const auto& [a, b, c] : faces) where_.add(box_of(a, b, c));
    for (const auto& [x, r] : supports) where_.add(Box3{x, x}.grown(widest * r));
  }
  bool near(const Box3& points, double reach) const { return points.grown(reach).meets(where_); }
  /// Whether they touch what the row of a point is made of: nodes that support it, the segments to these, the way aside. Where
  /// faces hide a node already, how far it is round a front is decided all about the point.
  bool concern(const Surroundings& around, const Vec3& place, const MaterialPoint& p) const {
    if (std::any_of(supports_.begin(), supports_.end(), [&](const auto& s) { return (s.first - p.position).norm() < growth[p.growth] * s.second; })) return true;
    std::vector<std::uint32_t> near;
    faces_.near(Box3{p.position, p.position}.grown(p.reach), near);
    if (near.empty() || p.blinded) return !near.empty();
    std::vector<Vec3> ends;
    around.nodes(p.position, growth[p.growth], near, ends);
    ends.push_back(place);
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
  for (std::size_t i = 0; i < points.size(); ++i) points[i].volume = 0.25 * cells[i / 4].volume;
}

// For each cell the number of the same one before, or ~0u; both lists are in Morton order.
std::vector<std::uint32_t> same_cells(std::span<const QuadratureCell> now, std::span<const QuadratureCell> before) {
  std::vector<std::uint32_t> same;
  std::size_t o = 0;
  for (const QuadratureCell& c : now) {
    while (o < before.size() && morton(before[o].cell.corner) < morton(c.cell.corner)) ++o;
    const bool found = o < before.size() && before[o].cell.corner == c.cell.corner && before[o].cell.level == c.cell.level;
    same.push_back(found ? static_cast<std::uint32_t>(o) : ~0u);
  }
  return same;
}

}  // namespace

Galerkin::Galerkin(const Body& body, MaterialPoints& points) : cells_(body), groups_(cells_.groups(cells_a_block)) {
  points.blocks.resize(groups_.size() - 1);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto cells = group(b);
      std::vector<MaterialPoint> all(4 * cells.size());
      std::vector<ShapeRow> rows(all.size());
      std::vector<std::uint32_t> stale(all.size());
      std::iota(stale.begin(), stale.end(), 0);
      points.blocks[b] = build(body, cells, std::move(all), rows, stale);
    }
  });
  points.connect(body.nodes.size());
}

// A block of points, of which some have their rows made anew.
PointBlock Galerkin::build(const Body& body, std::span<const QuadratureCell> cells, std::vector<MaterialPoint> points, std::span<ShapeRow> rows,
                           std::span<const std::uint32_t> stale) const {
  if (!stale.empty()) {
    Box3 box;
    for (const auto i : stale) box.add(cells[i / 4].point[i % 4]);
    Surroundings around(body, box);
    for (const auto i : stale) rows[i] = build_row(around, cells[i / 4].point[i % 4], points[i]);
  }
  set_volumes(cells, points);
  return {std::move(points), rows};
}

void Galerkin::note(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position) {
  const NodeSet& nodes = body.nodes;
  for (const auto* list : {&delta.crack.new_faces, &delta.crack.removed_faces})
    for (const FaceId f : *list) faces_.push_back(body.surface.corners(f));
  for (std::size_t i = delta.first_new_node.index(); i < nodes.size(); ++i) supports_.push_back({nodes.position[i], nodes.radius[i]});
  for (std::size_t k = 0; k < delta.moved_nodes.size(); ++k) {
    const std::size_t i = delta.moved_nodes[k].index();
    supports_.push_back({old_position[k], nodes.radius[i]}), supports_.push_back({nodes.position[i], nodes.radius[i]});
  }
}

bool Galerkin::settle(const Body& body, MaterialPoints& points, std::vector<std::uint32_t>& kept) {
  if (faces_.empty() && supports_.empty()) return false;
  const auto groups_before = groups_;
  std::vector<std::uint32_t> was(cells_.cells().size());  // per cell: its number before
  std::iota(was.begin(), was.end(), 0);
  if (!supports_.empty()) {
    const auto before = cells_.cells();
    if (cells_.follow(body)) {
      was = same_cells(cells_.cells(), before);
      groups_ = cells_.groups(cells_a_block);
      for (const auto c : was)
        for (std::uint32_t k = 0; k < 4; ++k) kept.push_back(c == ~0u ? c : 4 * c + k);
    }
  }
  const Changes changes(faces_, supports_);
  const double reach = widest * *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  std::vector<PointBlock> old(groups_.size() - 1);
  old.swap(points.blocks);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto cells = group(b);
      const std::span same(&was[groups_[b]], cells.size());
      const auto block_of = [&](std::uint32_t cell) { return static_cast<std::size_t>(std::upper_bound(groups_before.begin(), groups_before.end(), cell) - groups_before.begin() - 1); };
      const std::size_t o = same[0] == ~0u ? 0 : block_of(same[0]);
      bool whole = same[0] == groups_before[o] && groups_before[o + 1] - groups_before[o] == cells.size();
      for (std::size_t c = 1; c < cells.size() && whole; ++c) whole = same[c] == same[0] + c;
      if (whole && !changes.near(old[o].box, reach)) {
        points.blocks[b] = std::move(old[o]);
        set_volumes(cells, points.blocks[b].points);
        continue;
      }
      std::vector<MaterialPoint> all(4 * cells.size());
      std::vector<std::uint32_t> stale;
      Box3 box;
      for (std::uint32_t i = 0; i < all.size(); ++i) {
        const auto c = same[i / 4];
        if (c != ~0u) {
          const std::size_t from = block_of(c);
          all[i] = old[from].points[4 * (c - groups_before[from]) + i % 4];
          box.add(all[i].position);
        }
        box.add(cells[i / 4].point[i % 4]);
      }
      const Surroundings around(body, box);
      for (std::uint32_t i = 0; i < all.size(); ++i)
        if (same[i / 4] == ~0u || changes.concern(around, cells[i / 4].point[i % 4], all[i])) stale.push_back(i);
      if (whole && stale.empty()) {
        points.blocks[b] = std::move(old[o]);
        set_volumes(cells, points.blocks[b].points);
        continue;
      }
      std::vector<ShapeRow> rows(all.size());
      for (std::uint32_t i = 0, s = 0; i < all.size(); ++i) {
        if (s < stale.size() && stale[s] == i) {
          ++s;
          continue;
        }
        const auto c = same[i / 4];
        const std::size_t from = block_of(c);
        rows[i] = old[from].row(4 * (c - groups_before[from]) + i % 4);
      }
      points.blocks[b] = build(body, cells, std::move(all), rows, stale);
    }
  });
  points.connect(body.nodes.size());
  faces_.clear(), supports_.clear();
  return true;
}

}  // namespace geo
