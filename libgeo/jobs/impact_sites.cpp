// jobs/impact_sites.h: best-candidate sampling (Mitchell 1991), with distances relative to the
// spacing that is wanted at a candidate.
#include "jobs/impact_sites.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "base/elementary.h"
#include "base/random.h"
#include "score/voronoi.h"
#include "score/walls.h"

namespace geo {
namespace {

// Heights at which the line through (x, y) along an axis passes triangles, ascending.
std::vector<double> heights_along(const TriangleMesh& mesh, int axis, double x, double y) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  std::vector<double> heights;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double px = p[i] - x, qx = q[i] - x, rx = r[i] - x;
    if ((px < 0) == (qx < 0) && (qx < 0) == (rx < 0)) continue;
    const double py = p[j] - y, qy = q[j] - y, ry = r[j] - y;
    const double u = qx * ry - qy * rx, v = rx * py - ry * px, w = px * qy - py * qx, sum = u + v + w;
    if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) || sum == 0) continue;
    heights.push_back((u * p[axis] + v * q[axis] + w * r[axis]) / sum);
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

// The wanted spacing at a point over that far away: it grows with a power of the distance from the
// impact, from a tenth of the diagonal on.
double spacing_at(const Vec3& p, const Vec3& impact, double diagonal, double grading) {
  return std::pow(0.1 + (p - impact).norm() / diagonal, grading);
}

}  // namespace

std::vector<Vec3> inner_points(const TriangleMesh& mesh, std::uint64_t seed) {
  constexpr int lines = 8, points = 24;  // lines across an extent, points along it: 1,500 of a block
  const Box3 box = bounding_box(mesh);
  const Vec3 size = box.hi - box.lo;
  int axis = 0;
  size.maxCoeff(&axis);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Random random(seed);
  std::vector<Vec3> result;
  for (int k = 0; k < lines * lines; ++k) {
    const double x = box.lo[i] + size[i] * ((k % lines) + random.uniform()) / lines;
    const double y = box.lo[j] + size[j] * (int(k / lines) + random.uniform()) / lines;
    const std::vector<double> heights = heights_along(mesh, axis, x, y);
    if (heights.size() % 2 != 0) continue;  // the line touches an edge
    double at = box.lo[axis] + size[axis] / points * random.uniform();
    for (std::size_t h = 0; h < heights.size(); h += 2)
      for (; at < heights[h + 1]; at += size[axis] / points)
        if (at > heights[h]) {
          Vec3& p = result.emplace_back();
          p[i] = x;
          p[j] = y;
          p[axis] = at;
        }
  }
  return result;
}

Mat3 shortened_along(const Vec3& direction, double elongation) {
  const Vec3 axis = direction.stableNormalized();
  return Mat3::Identity() - (1 - 1 / elongation) * axis * axis.transpose();
}

std::vector<Vec3> impact_sites(std::span<const Vec3> among, int count, const Impact& impact,
                               const ImpactOptions& options, const Mat3& stretch) {
  constexpr int candidates = 40;
  std::vector<Vec3> sites;
  if (among.empty()) return sites;
  Box3 box;
  for (const Vec3& p : among) box.add(p);
  const double diagonal = std::max(box.diagonal(), std::numeric_limits<double>::min());
  const auto nearer = [&](const Vec3& p, const Vec3& q) {
    return (p - impact.point).squaredNorm() < (q - impact.point).squaredNorm();
  };
  sites.push_back(*std::min_element(among.begin(), among.end(), nearer));
  Random random(options.seed);
  while (sites.size() < static_cast<std::size_t>(count)) {
    double best = 0;
    Vec3 chosen = Vec3::Zero();
    for (int k = 0; k < candidates; ++k) {
      const Vec3& p = among[static_cast<std::size_t>(random.below(among.size()))];
      double distance = std::numeric_limits<double>::infinity();
      for (const Vec3& site : sites) distance = std::min(distance, (stretch * (p - site)).norm());
      distance /= spacing_at(p, impact.point, diagonal, options.grading);
      if (distance > best) {
        best = distance;
        chosen = p;
      }
    }
    if (best == 0) break;  // there are no more points
    sites.push_back(chosen);
  }
  return sites;
}

int site_count(double volume, const Impact& impact, const ImpactOptions& options) {
  constexpr double wall_of_cells = 2.91;  // half of 5.82, the mean surface of a cell of volume 1
  const double area = impact.energy / options.toughness;
  const double root = area / (wall_of_cells * cube_root(volume) * cube_root(volume));
  return static_cast<int>(std::min(std::round(root * root * root), double(options.max_pieces)));
}

std::size_t nearest_site(std::span<const Vec3> sites, const Vec3& point, const Mat3& stretch) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < sites.size(); ++s)
    if (const double d = (stretch * (sites[s] - point)).squaredNorm(); d < least) {
      least = d;
      nearest = s;
    }
  return nearest;
}

TriangleMesh walls_between(std::span<const Vec3> sites, std::span<const int> group, const Box3& box,
                           const Mat3& stretch) {
  std::vector<Vec3> stretched;
  for (const Vec3& site : sites) stretched.push_back(stretch * site);
  TriangleMesh walls = voronoi_walls(stretched, box_along(box, stretch.transpose()));
  std::erase_if(walls.triangles, [&](const Triangle& t) {
    const Vec3 middle = (walls.vertices[t[0]] + walls.vertices[t[1]] + walls.vertices[t[2]]) / 3;
    std::size_t near[2] = {0, 0};  // the two sites whose wall it is
    double distance[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (std::size_t s = 0; s < stretched.size(); ++s) {
      const double d = (stretched[s] - middle).squaredNorm();
      if (d < distance[0]) {
        distance[1] = std::exchange(distance[0], d);
        near[1] = std::exchange(near[0], s);
      } else if (d < distance[1]) {
        distance[1] = d;
        near[1] = s;
      }
    }
    return group[near[0]] == group[near[1]];
  });
  const Mat3 back = stretch.inverse();
  for (Vec3& p : walls.vertices) p = back * p;
  return walls;
}

}  // namespace geo
