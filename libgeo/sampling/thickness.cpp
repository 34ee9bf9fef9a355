// Rays against triangles by Möller and Trumbore 1997. A triangle's part in a cell is clipped plane
// by plane (Sutherland and Hodgman 1974).
#include "sampling/thickness.h"

#include <cmath>

namespace geo {
namespace {

constexpr double facing = 0.9;  // least cosine between a wall's two sides, see thickness.h
constexpr double none = std::numeric_limits<double>::infinity();

/// The distance at which the ray from p leaves the material; infinite where that is beyond
/// `length`, or where the ray meets a face at a small angle. The ray starts on triangle `from`. It
/// is searched in `parts` boxes: one box around a slanting ray would contain most triangles near
/// it.
double exit_distance(const RegionTree& tree, const Vec3& p, const Vec3& direction, double length, std::uint32_t from,
                     int parts) {
  std::vector<std::uint32_t> rows;
  for (int part = 0; part < parts; ++part) {
    Box3 box;
    box.add(p + direction * (length * part / parts));
    box.add(p + direction * (length * (part + 1) / parts));
    rows.clear();
    tree.tree().near(box, rows);
    double first = none;
    bool across = false;
    for (const auto row : rows) {
      if (row == from) continue;
      const auto& [a, b, c] = tree.corners(row);
      const Vec3 u = b - a, v = c - a, w = direction.cross(v);
      const double det = u.dot(w);
      if (det == 0) continue;
      const Vec3 s = p - a, q = s.cross(u);
      const double x = s.dot(w) / det, y = direction.dot(q) / det, t = v.dot(q) / det;
      if (x < 0 || y < 0 || x + y > 1 || !(t > 0) || t > length || t >= first) continue;
      first = t;
      across = tree.normal(row).dot(direction) >= facing;
    }
    // A hit beyond this part may not be the first.
    if (first <= length * (part + 1) / parts) return across ? first : none;
  }
  return none;
}

/// The centroid of the corners, and the area, of the part of a triangle that is in a box; false
/// where there is none.
bool part_in_box(const std::array<Vec3, 3>& t, const Box3& box, Vec3& middle, double& area) {
  Vec3 polygon[2][10];  // each of six planes adds one corner at most
  int n = 3, now = 0;
  std::copy(t.begin(), t.end(), polygon[0]);
  for (int plane = 0; plane < 6 && n > 0; ++plane) {
    const int axis = plane / 2;
    const auto depth = [&](const Vec3& p) { return plane % 2 ? box.hi[axis] - p[axis] : p[axis] - box.lo[axis]; };
    const Vec3* in = polygon[now];
    Vec3* out = polygon[1 - now];
    int count = 0;
    for (int i = 0; i < n; ++i) {
      const Vec3 &p = in[i], &q = in[(i + 1) % n];
      const double dp = depth(p), dq = depth(q);
      if (dp >= 0) out[count++] = p;
      if ((dp >= 0) != (dq >= 0)) out[count++] = p + dp / (dp - dq) * (q - p);
    }
    n = count;
    now = 1 - now;
  }
  middle = Vec3::Zero();
  Vec3 twice = Vec3::Zero();
  for (int i = 0; i < n; ++i) {
    middle += polygon[now][i] / n;
    twice += (polygon[now][i] - polygon[now][0]).cross(polygon[now][(i + 1) % n] - polygon[now][0]);
  }
  area = 0.5 * twice.norm();
  return n > 0;
}

}  // namespace

Wall wall_behind(const RegionTree& tree, std::uint32_t triangle, double limit) {
  const auto& [a, b, c] = tree.corners(triangle);
  const Vec3 p = (a + b + c) / 3;
  Wall wall;
  wall.area = 0.5 * (b - a).cross(c - a).norm();
  wall.thickness = exit_distance(tree, p, -tree.normal(triangle), limit, triangle, 8);
  if (wall.thickness < none) wall.at = p - 0.5 * wall.thickness * tree.normal(triangle);
  return wall;
}

Wall thinnest_wall(const RegionTree& tree, const Lattice& lattice, const Region& cut, double limit) {
  Wall wall;
  const Box3 box = lattice.box(cut.cell);
  // A sample of very many small triangles suffices: walls worth finer cells consist of many.
  const std::size_t step = 1 + cut.triangles.size() / 64;
  const int parts = cut.triangles.size() < 8 ? 1 : 8;
  for (std::size_t i = 0; i < cut.triangles.size(); i += step) {
    const std::uint32_t triangle = cut.triangles[i];
    Vec3 p;
    double area;
    if (!part_in_box(tree.corners(triangle), box, p, area)) continue;
    const double t = exit_distance(tree, p, -tree.normal(triangle), limit, triangle, parts);
    if (t < none) wall.area += area;
    if (t < wall.thickness) {
      wall.thickness = t;
      wall.at = p - 0.5 * t * tree.normal(triangle);
    }
  }
  return wall;
}

Wall wall_around(const RegionTree& tree, const Vec3& p, const TriangleBvh::Closest& closest, double limit) {
  if (!(closest.distance > 0)) return {};
  const Vec3 direction = (p - closest.point) / closest.distance;
  if (tree.normal(closest.triangle).dot(direction) > -facing) return {};
  const double rest = exit_distance(tree, p, direction, limit - closest.distance, closest.triangle, 2);
  if (!(rest < none)) return {};
  return {closest.distance + rest, p + 0.5 * (rest - closest.distance) * direction, 0};
}

}  // namespace geo
