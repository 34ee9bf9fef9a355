// Each cell is the box, clipped by bisectors with the other sites in order of distance. No site
// farther than twice the cell's radius can clip it. A vertex solves the three plane equations
// (s_j − s_i) · (x − s_i) = |s_j − s_i|² / 2; its name, four sites or box sides, is unique.
#include "score/voronoi.h"

#include <algorithm>
#include <deque>
#include <map>
#include <numeric>
#include <optional>

#include <Eigen/LU>

#include "base/random.h"
#include "crack/index_map.h"
#include "kerf/error.h"
#include "score/walls.h"

namespace geo {
namespace {

using Name = std::array<std::uint32_t, 4>;  // ascending sites, then box sides as count + side

struct NameHash {
  std::size_t operator()(const Name& name) const {
    const crack::SpreadHash spread;
    return spread(spread(std::uint64_t(name[0]) << 32 | name[1]) ^ (std::uint64_t(name[2]) << 32 | name[3]));
  }
};

// The vertices of the diagram, by name: each name has one position.
class Corners {
 public:
  Corners(std::span<const Vec3> sites, const Box3& box) : sites_(sites), box_(box) {}

  static Name name_of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    Name name{a, b, c, d};
    std::sort(name.begin(), name.end());
    return name;
  }
  const Vec3& at(const Name& name) {
    std::uint32_t& index = indices_[name];
    if (index == ~0u) {
      index = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(position(name));
    }
    return positions_[index];
  }
  // Whether the corner is nearer to `site` than to its defining sites.
  bool beyond(const Name& name, std::uint32_t site) {
    const Vec3& p = at(name);
    return (p - sites_[site]).squaredNorm() < (p - sites_[name[0]]).squaredNorm();
  }

 private:
  Vec3 position(const Name& name) const {
    const Vec3& s = sites_[name[0]];
    Mat3 rows;
    Vec3 right;
    for (int k = 0; k < 3; ++k) {
      const auto other = name[std::size_t(k) + 1];
      if (other < sites_.size()) {
        const Vec3 d = sites_[other] - s;
        rows.row(k) = d.normalized();
        right[k] = 0.5 * d.norm();
      } else {
        const auto side = other - sites_.size();
        const int axis = int(side % 3);
        rows.row(k) = Vec3::Unit(axis);
        right[k] = (side < 3 ? box_.lo : box_.hi)[axis] - s[axis];
      }
    }
    return s + rows.partialPivLu().solve(right);
  }

  std::span<const Vec3> sites_;
  const Box3& box_;
  crack::IndexMap<Name, NameHash> indices_;  // into positions_
  std::deque<Vec3> positions_;               // references stay valid
};

// A side of a convex cell: its plane, and its corners in order. The cell itself names one of the
// planes at a corner.
struct Side {
  std::uint32_t plane;
  std::vector<Name> loop;
};
using Cell = std::vector<Side>;

Cell box_cell(std::uint32_t site, std::uint32_t count) {
  Cell cell;
  for (std::uint32_t side = 0; side < 6; ++side) {
    const std::uint32_t u = (side + 1) % 3, v = (side + 2) % 3;
    Side face{count + side, {}};
    for (const auto& [a, b] : {std::pair{u, v}, {u + 3, v}, {u + 3, v + 3}, {u, v + 3}})
      face.loop.push_back(Corners::name_of(site, count + side, count + a, count + b));
    if (side < 3) std::reverse(face.loop.begin(), face.loop.end());
    cell.push_back(std::move(face));
  }
  return cell;
}

// The plane, other than the side\'s own, that two consecutive corners of a side share.
std::uint32_t shared_plane(const Name& a, const Name& b, std::uint32_t site, std::uint32_t plane) {
  for (const auto p : a)
    if (p != site && p != plane && std::find(b.begin(), b.end(), p) != b.end()) return p;
  return ~0u;
}

// Clips a cell by the bisector of its site and `other`. False when rounding misplaces corners so
// that they make no polygon.
bool clip(Cell& cell, std::uint32_t site, std::uint32_t other, Corners& corners) {
  std::map<Name, Name> next;  // along the new side
  bool any = false;
  for (auto& side : cell) {
    const auto& loop = side.loop;
    std::vector<Name> clipped;
    std::optional<Name> entry, exit;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Name &a = loop[i], &b = loop[(i + 1) % loop.size()];
      const bool a_off = corners.beyond(a, other), b_off = corners.beyond(b, other);
      if (!a_off) clipped.push_back(a);
      if (a_off == b_off) continue;
      const auto third = shared_plane(a, b, site, side.plane);
      if (third == ~0u) return false;
      const Name cut = Corners::name_of(site, side.plane, third, other);
      auto& which = b_off ? exit : entry;
      if (which) return false;
      which = cut;
      clipped.push_back(cut);
    }
    any = any || clipped.size() != loop.size() || entry;
    if (entry && exit) next[*entry] = *exit;
    side.loop = std::move(clipped);
  }
  std::erase_if(cell, [](const Side& s) { return s.loop.empty(); });
  if (!any) return true;
  if (next.size() < 3) return false;
  Side fresh{other, {}};
  Name at = next.begin()->first;
  do {
    fresh.loop.push_back(at);
    const auto found = next.find(at);
    if (found == next.end()) return false;
    at = found->second;
  } while (at != fresh.loop.front() && fresh.loop.size() <= next.size());
  if (fresh.loop.size() != next.size()) return false;
  cell.push_back(std::move(fresh));
  return true;
}

// All walls; none when the sites are in degenerate position for names of four. A vertex loses about
// as many digits as the edges at it are short: half of all digits must remain.
std::optional<TriangleMesh> walls_of(std::span<const Vec3> sites, const Box3& box, const std::function<void()>& pause) {
  const auto count = static_cast<std::uint32_t>(sites.size());
  Corners corners(sites, box);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Name>> walls;
  std::size_t matched = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (pause) pause();
    std::vector<std::pair<double, std::uint32_t>> others;
    for (std::uint32_t j = 0; j < count; ++j)
      if (j != i) others.push_back({(sites[j] - sites[i]).squaredNorm(), j});
    std::sort(others.begin(), others.end());
    Cell cell = box_cell(i, count);
    double radius2 = std::numeric_limits<double>::infinity();
    for (const auto& [distance2, j] : others) {
      if (distance2 > 4.0001 * radius2) break;  // |s_j − s_i| > 2 · radius, with a margin for rounding
      if (!clip(cell, i, j, corners)) return std::nullopt;
      radius2 = 0;
      for (const auto& side : cell)
        for (const auto& name : side.loop) radius2 = std::max(radius2, (corners.at(name) - sites[i]).squaredNorm());
    }
    for (auto& side : cell) {
      if (side.plane >= count) continue;
      if (side.plane > i) {
        walls[{i, side.plane}] = std::move(side.loop);
        continue;
      }
      // The cell on the other side must have the same wall.
      const auto found = walls.find({side.plane, i});
      if (found == walls.end()) return std::nullopt;
      auto mine = side.loop, theirs = found->second;
      std::sort(mine.begin(), mine.end());
      std::sort(theirs.begin(), theirs.end());
      if (mine != theirs) return std::nullopt;
      ++matched;
    }
  }
  if (matched != walls.size()) return std::nullopt;
  TriangleMesh mesh;
  std::map<Name, std::uint32_t> index;
  for (const auto& [pair, loop] : walls) {
    std::vector<std::uint32_t> polygon;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Name& name = loop[i];
      if ((corners.at(name) - corners.at(loop[(i + 1) % loop.size()])).norm() < 0x1p-26 * box.diagonal())
        return std::nullopt;
      const auto [entry, fresh] = index.try_emplace(name, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (fresh) mesh.vertices.push_back(corners.at(name));
      polygon.push_back(entry->second);
    }
    add_wall(mesh, polygon);
  }
  return mesh;
}

}  // namespace

TriangleMesh voronoi_walls(std::span<const Vec3> sites, const Box3& box, const std::function<void()>& pause) {
  if (sites.size() < 2) throw InputError("Voronoi cells need at least two sites");
  for (const Vec3& s : sites)
    if (!Box3{s, s}.meets(box)) throw InputError("a site is outside of the box");
  std::vector<Vec3> moved(sites.begin(), sites.end());
  auto sorted = moved;
  std::sort(sorted.begin(), sorted.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) throw InputError("two sites are at one place");
  Random random(sites.size());
  // Displacements of 2⁻¹⁶ … 2⁻⁷ of the diagonal: the first that helps is used.
  for (double by = 0x1p-16 * box.diagonal(); by < 0x1p-6 * box.diagonal(); by *= 2) {
    if (auto walls = walls_of(moved, box, pause)) return *walls;
    for (std::size_t i = 0; i < moved.size(); ++i)
      moved[i] = (sites[i] + by * random.direction()).cwiseMax(box.lo).cwiseMin(box.hi);
  }
  throw GeometryError("the sites' cells cannot be told apart");
}

}  // namespace geo
