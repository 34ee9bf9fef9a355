#include "mechanics/galerkin.h"

#include <algorithm>
#include <map>

#include "base/parallel.h"
#include "body/locate.h"

namespace geo {
namespace {

constexpr std::size_t cells_a_block = 256;
constexpr std::size_t few = 8;          // a point with fewer nodes, or a worse moment matrix, widens its support
constexpr double ill_conditioned = 500;
constexpr double hopeless = 1e7;        // linear fields would be off by 1e-9 of their size
constexpr std::array growth{1.0, 1.2, 1.44, 1.728, 2.0736};

// What a point's row is made of: nodes near it, and the faces that may hide them.
struct Surroundings {
  const Body& body;
  const TriangleBvh& faces;
  double longest;  // no node's support is longer
};

// A point that a face passes through is on neither of its sides: it steps aside, towards the nearest node.
Vec3 off_faces(const Surroundings& around, const Vec3& p) {
  if (!around.faces.blocks(p, p)) return p;
  const auto near = around.body.grid.nearest(around.body.nodes.position, p, 1, ~0u, [](auto) { return true; });
  for (double step = 1e-3; step < 0.5; step *= 4)
    if (const Vec3 aside = p + step * (around.body.nodes.position[near[0]] - p); !around.faces.blocks(aside, aside)) return aside;
  return p;
}

ShapeRow build_row(const Surroundings& around, const Vec3& place, MaterialPoint& point) {
  const NodeSet& nodes = around.body.nodes;
  const Vec3 x = off_faces(around, place);
  point.position = x, point.reach = (x - place).norm();
  ShapeRow row;
  std::vector<std::uint32_t> near;
  std::vector<Vec3> at;
  std::vector<double> reach;
  std::vector<std::uint8_t> hidden;
  double condition = 0;
  for (std::size_t t = 0;; ++t) {
    const double grown = growth[t];
    near.clear(), at.clear(), reach.clear(), row.to.clear();
    around.body.grid.within(nodes.position, x, grown * around.longest, near);
    std::vector<Vec3> ends;
    for (const auto j : near)
      if ((nodes.position[j] - x).norm() < grown * nodes.radius[j]) near[ends.size()] = j, ends.push_back(nodes.position[j]);
    near.resize(ends.size());
    hidden.assign(ends.size(), 0);
    if (!around.faces.empty()) around.faces.blocks(x, ends, hidden.data());
    point.growth = static_cast<std::uint8_t>(t);
    for (std::size_t q = 0; q < near.size(); ++q) {
      point.reach = std::max(point.reach, (ends[q] - x).norm());
      if (hidden[q]) continue;
      row.to.push_back(near[q]), at.push_back(ends[q]), reach.push_back(grown * nodes.radius[near[q]]);
    }
    condition = shape_gradients(x, at, reach, row.gradient);
    if ((row.to.size() >= few && condition <= ill_conditioned) || t + 1 == growth.size()) break;
  }
  point.rung = condition <= ill_conditioned ? Rung::full : condition <= hopeless ? Rung::regularised : Rung::rigid;
  if (point.rung == Rung::rigid) row.to.clear(), row.gradient.clear();
  return row;
}

double longest_support(const NodeSet& nodes) { return *std::max_element(nodes.radius.begin(), nodes.radius.end()); }

PointBlock build_block(const Surroundings& around, std::span<const QuadratureCell> cells) {
  std::vector<MaterialPoint> points(4 * cells.size());
  std::vector<ShapeRow> rows(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].volume = 0.25 * cells[i / 4].volume;
    rows[i] = build_row(around, cells[i / 4].point[i % 4], points[i]);
  }
  return {std::move(points), rows};
}

}  // namespace

Galerkin::Galerkin(const Body& body, MaterialPoints& points) : cells_(body), groups_(cells_.groups(cells_a_block)) { build(body, points); }

void Galerkin::build(const Body& body, MaterialPoints& points) const {
  std::vector<std::array<Vec3, 3>> faces;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) faces.push_back(body.surface.corners(FaceId(f)));
  const TriangleBvh tree(faces);
  const Surroundings around{body, tree, longest_support(body.nodes)};
  points.blocks.assign(groups_.size() - 1, {});
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      points.blocks[b] = build_block(around, {&cells_.cells()[groups_[b]], groups_[b + 1] - groups_[b]});
  });
  points.connect(body.nodes.size());
}

void Galerkin::update(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position, MaterialPoints& points, std::vector<std::uint32_t>& kept) {
  const NodeSet& nodes = body.nodes;
  const bool nodes_changed = delta.first_new_node.index() < nodes.size() || !delta.moved_nodes.empty();
  const auto key = [](const QuadratureCell& c) { return std::pair(morton(c.cell.corner), c.cell.level); };
  std::map<std::pair<std::uint64_t, std::int32_t>, std::uint32_t> before;
  if (nodes_changed) {
    const auto old = cells_.cells();
    if (cells_.follow(body)) {
      for (std::size_t c = 0; c < old.size(); ++c) before[key(old[c])] = static_cast<std::uint32_t>(4 * c);
      for (const QuadratureCell& c : cells_.cells()) {
        const auto at = before.find(key(c));
        for (std::uint32_t k = 0; k < 4; ++k) kept.push_back(at == before.end() ? ~0u : at->second + k);
      }
      groups_ = cells_.groups(cells_a_block);
      build(body, points);
      return;
    }
  }
  // What has changed: faces, and the supports of nodes that came, went or moved.
  std::vector<std::array<Vec3, 3>> changed;
  Box3 where;
  for (const auto* list : {&delta.crack.new_faces, &delta.crack.removed_faces})
    for (const FaceId f : *list) {
      changed.push_back(body.surface.corners(f));
      where.add(box_of(changed.back()[0], changed.back()[1], changed.back()[2]));
    }
  const TriangleBvh changed_faces(changed);
  std::vector<std::pair<Vec3, double>> supports;
  for (std::size_t i = delta.first_new_node.index(); i < nodes.size(); ++i) supports.push_back({nodes.position[i], nodes.radius[i]});
  for (std::size_t k = 0; k < delta.moved_nodes.size(); ++k) {
    const std::size_t i = delta.moved_nodes[k].index();
    supports.push_back({old_position[k], nodes.radius[i]}), supports.push_back({nodes.position[i], nodes.radius[i]});
  }
  for (const auto& [x, r] : supports) where.add(Box3{x, x}.grown(r));
  const double longest = longest_support(nodes), widest = growth.back() * longest;
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      PointBlock& block = points.blocks[b];
      if (!block.box.grown(widest).meets(where)) continue;
      std::vector<std::uint32_t> stale, near;
      Box3 around;
      for (std::uint32_t i = 0; i < block.points.size(); ++i) {
        const MaterialPoint& p = block.points[i];
        near.clear();
        changed_faces.near(Box3{p.position, p.position}.grown(p.reach), near);
        if (near.empty() && std::none_of(supports.begin(), supports.end(), [&](const auto& s) { return (s.first - p.position).norm() < growth[p.growth] * s.second; })) continue;
        stale.push_back(i);
        around.add(p.position);
        around.add(cells_.cells()[groups_[b] + i / 4].point[i % 4]);
      }
      if (stale.empty()) continue;
      std::vector<std::array<Vec3, 3>> faces;
      triangles_near(body.surface, around.grown(widest), faces);
      const TriangleBvh tree(faces);
      auto all = block.points;
      auto rows = block.rows();
      for (const auto i : stale) rows[i] = build_row({body, tree, longest}, cells_.cells()[groups_[b] + i / 4].point[i % 4], all[i]);
      block = PointBlock(std::move(all), rows);
    }
  });
  points.connect(nodes.size());
}

}  // namespace geo
