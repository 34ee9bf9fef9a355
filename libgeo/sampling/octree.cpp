// Cells are classified top-down on all threads. Then the 2:1 rule is applied bottom-up, level by
// level, on sorted Morton codes (as in Sundar et al. 2008).
#include "sampling/octree.h"

#include <atomic>

#include "sampling/walk.h"

namespace geo {
namespace {

struct Division {
  int level;  // of the cell to be divided; 0: it cannot be, but should
  std::uint64_t code;
  Wall wall;      // thin material that was met
  bool resolved;  // by dividing
};

void take_thinner(Wall& wall, const Wall& other) {
  if (other.thickness < wall.thickness) wall = other;
}

}  // namespace

void balance(Divisions& divided) {
  for (std::size_t level = 1; level < divided.size(); ++level) {
    auto& codes = divided[level];
    std::sort(codes.begin(), codes.end());
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
    if (level + 1 == divided.size()) break;
    // The parts of a divided cell want neighbours of its own level: their parents, eight at most,
    // are divided.
    auto& above = divided[level + 1];
    const std::int32_t edge = 1 << level;
    for (const auto code : codes) {
      const auto c = corner_of(code);
      for (int k = 0; k < 8; ++k) {
        std::array<std::int32_t, 3> p;
        for (int i = 0; i < 3; ++i) p[i] = (c[i] + (k >> i & 1 ? edge : -edge)) & ~(2 * edge - 1);
        if (std::min({p[0], p[1], p[2]}) < 0) continue;
        if (const auto m = morton(p); above.empty() || above.back() != m) above.push_back(m);
      }
    }
  }
}

std::optional<Divisions> plan_octree(const RegionTree& tree, const OctreeShape& shape, std::size_t most,
                                     ThinPlaces& thin, const Progress& progress) {
  Divisions divided(static_cast<std::size_t>(shape.top) + 1);
  const int across = shape.across;
  if (shape.top == 0 && across == 0) return divided;
  const int last = std::min(shape.regular, 1);  // level of the last cells to look at
  std::atomic<std::size_t> count{0};
  const auto visit = [&](const Region& region, std::vector<Division>& found) {
    const Cell& cell = region.cell;
    const double edge = shape.lattice.edge(cell.level);
    if (count.load(std::memory_order_relaxed) > most) return false;
    if (cell.level > shape.top) {
      if (region.cut()) return true;
      // Deep inside nothing asks to be divided: the parts' middles are that far from the cell's.
      const double reach = 0.5 * std::sqrt(3.0) * edge + 0.5 * edge * std::max(1.0, 0.5 * (across - 1));
      return tree.tree().closest(region.probe, reach).triangle != ~0u;
    }
    bool divide = false;
    Wall wall;
    if (region.cut()) {
      divide = cell.level > shape.regular;
      if (!divide && across > 0) wall = thinnest_wall(tree, shape.lattice, region, across * edge);
    } else {
      // Cells of both sides of a wall count; those inside may be as large as what they leave.
      const double limit = (across - 1) * edge;
      const auto closest =
          tree.tree().closest(region.probe, std::max(cell.level > shape.regular ? edge : 0.0, 0.5 * limit));
      if (closest.triangle == ~0u) return false;
      divide = cell.level > shape.regular && closest.distance < edge;
      if (!divide && across > 0) wall = wall_around(tree, region.probe, closest, limit);
    }
    divide |= wall.thickness < std::numeric_limits<double>::infinity();
    if (divide) {
      ++count;
      found.push_back({.level = cell.level,
                       .code = morton(cell.corner),
                       .wall = wall,
                       .resolved = cell.level > last || !(wall.thickness < across * shape.lattice.size)});
    }
    return divide && cell.level > last;
  };
  const auto lists = walk<Division>(tree, shape.lattice, {{0, 0, 0}, shape.root}, "octree", progress, visit);
  if (count > most) return std::nullopt;
  for (const auto& list : lists)
    for (const Division& d : list) {
      if (d.level > 0) divided[static_cast<std::size_t>(d.level)].push_back(d.code);
      take_thinner(thin.thinnest, d.wall);
      if (!d.resolved) take_thinner(thin.unresolved, d.wall);
    }
  balance(divided);
  return divided;
}

}  // namespace geo
