#include "body/nodes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "sampling/resample.h"

namespace geo {

void set_sampled(Body& body, std::uint32_t count) {
  body.sampled = count;
  body.finest = *std::min_element(body.nodes.spacing.begin(), body.nodes.spacing.begin() + count);
  body.widest = *std::max_element(body.nodes.radius.begin(), body.nodes.radius.begin() + count);
}

NodeId insert_node(Body& body, const Vec3& x, NodeId donor, double spacing) {
  const NodeId id(body.nodes.size());
  NodeSet& nodes = body.nodes;
  nodes.position.push_back(x);
  nodes.spacing.push_back(spacing);
  nodes.radius.push_back(double(nodes.radius[donor.index()]));
  nodes.volume[donor.index()] *= 0.5;  // exact, so the sum is conserved to the bit
  nodes.volume.push_back(double(nodes.volume[donor.index()]));
  body.debris.push_back(0);
  body.donors.push_back(donor);
  body.grid.insert(nodes.position, id.value);
  return id;
}

std::size_t insert_near(Body& body, const std::vector<FaceId>& faces, double spacing, std::uint64_t seed,
                        std::size_t limit) {
  if (faces.empty()) return 0;
  const auto all = [](std::uint32_t) { return true; };
  std::vector<std::array<Vec3, 3>> soup;
  for (const FaceId f : faces) soup.push_back(body.surface.corners(f));
  // A crack is a boundary, and an octree's leaves halve at most from one to the next: half of what the nearest node to each cell of
  // a lattice has, which is as fine as nodes usually are. Of the nodes that the body was built of: else each step would halve anew.
  const double cell = body.grid.cell();
  std::map<std::array<double, 3>, double> found;
  const auto spacing_at = [&](const Vec3& x) {
    if (spacing > 0) return spacing;
    const std::array<double, 3> at{std::floor(x[0] / cell), std::floor(x[1] / cell), std::floor(x[2] / cell)};
    const auto [place, fresh] = found.try_emplace(at, 0);
    if (fresh) {
      const double there = body.nodes.spacing[body.grid.nearest(body.nodes.position, cell * (Vec3(at.data()) + Vec3::Constant(0.5)), 1, ~0u, [&](std::uint32_t i) { return i < body.sampled; })[0]];
      place->second = std::min(there, std::max(body.finest, 0.5 * there));
    }
    return place->second;
  };
  std::size_t count = 0;
  std::vector<std::uint32_t> near;
  for (const auto& s : offset_samples(soup, spacing_at, seed)) {
    if (!stands_before(body.surface, {faces[s.face], s.side}, s.base, s.position)) continue;
    near.clear();
    body.grid.within(body.nodes.position, s.position, 0.6 * s.spacing, near);
    if (std::any_of(near.begin(), near.end(),
                    [&](std::uint32_t i) { return !is_blocked(body.surface, body.nodes.position[i], s.position); }))
      continue;
    // The donor is the nearest node that sees it; else, in a fresh sliver, the nearest of all.
    const auto nearest = body.grid.nearest(body.nodes.position, s.position, 24, ~0u, all);
    std::vector<std::uint32_t> seen;
    for (const auto i : nearest)
      if (seen.size() < 12 && !is_blocked(body.surface, body.nodes.position[i], s.position)) seen.push_back(i);
    // Where rounding has exchanged two sheets, even air may be before a side with material.
    if (seen.empty() && !is_inside(body.surface, s.position)) continue;
    const NodeId donor(seen.empty() ? nearest[0] : seen[0]);
    const NodeId node = insert_node(body, s.position, donor, s.spacing);
    if (spacing == 0 && !seen.empty()) {
      // In proportion, and wide enough for a dozen, as those of the sampling are.
      const double reach = std::min((body.nodes.position[seen.back()] - s.position).norm(), 3 * s.spacing);
      double& radius = body.nodes.radius[node.index()];
      radius = std::min(body.widest, std::max(radius * (s.spacing / body.nodes.spacing[donor.index()]), 1.05 * reach));
    }
    if (++count == limit) break;
  }
  return count;
}

std::vector<NodeId> move_off(Body& body, const std::vector<FaceId>& faces) {
  std::vector<NodeId> moved;
  std::vector<std::uint32_t> near;
  for (const FaceId f : faces) {
    const auto t = body.surface.corners(f);
    near.clear();
    // Those in cubes along the face: the ball about a large one would be the whole body.
    body.grid.walk(
        [&](int, const Vec3& middle, double half) {
          const double reach = std::numbers::sqrt3 * half + 0.1 * body.grid.cell();
          return (closest_point_on_triangle(middle, t[0], t[1], t[2]) - middle).squaredNorm() <= reach * reach;
        },
        [&](int, std::uint32_t i) { near.push_back(i); });
    std::sort(near.begin(), near.end());
    for (const auto i : near) {
      const Vec3 x = body.nodes.position[i];
      const double spacing = body.nodes.spacing[i];
      const double d = (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm();
      if (d > 0.02 * spacing) continue;
      const int above = orient3d(t[0], t[1], t[2], x);
      const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      // A node on the face takes any side, and where faces meet any way out.
      std::vector<Vec3> ways{above < 0 ? Vec3(-n) : n};
      if (above == 0) {
        ways.push_back(-n);
        for (Random random(i); ways.size() < 16;) ways.push_back(random.direction());
      }
      // As far as there is room, at most a tenth of the spacing. The faces that it is on are left behind, no other is passed.
      std::vector<FaceId> around;
      body.surface.near(Box3{x, x}.grown(0.1 * spacing), around);
      const auto on = std::partition(around.begin(), around.end(), [&](FaceId g) { return !touches(body.surface, g, x, x); });
      const auto way = [&](const Vec3& along) {
        for (double step = 0.1 * spacing; step > 1e-6 * spacing; step *= 0.5)
          if (std::none_of(around.begin(), on, [&](FaceId g) { return touches(body.surface, g, x, x + step * along); }) &&
              std::none_of(on, around.end(), [&](FaceId g) { return touches(body.surface, g, x + 1e-3 * step * along, x + step * along); }))
            return Vec3(step * along);
        return Vec3(Vec3::Zero());
      };
      for (const Vec3& along : ways) {
        const Vec3 move = way(along);
        if (move == Vec3::Zero()) continue;
        body.grid.erase(i, x);
        body.nodes.position[i] = x + move;
        body.grid.insert(body.nodes.position, i);
        moved.push_back(NodeId(i));
        break;
      }
    }
  }
  std::sort(moved.begin(), moved.end());
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  return moved;
}

void mark_debris(Body& body, const std::vector<NodeId>& nodes) {
  parallel_for(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t i = nodes[n].index();
      Mat3 moment = Mat3::Zero();
      for (const auto& neighbor : body.graph.neighbors(body.nodes, nodes[n])) {
        const Vec3 x = (body.nodes.position[neighbor.to.index()] - body.nodes.position[i]) / body.nodes.radius[i];
        moment += x * x.transpose();
      }
      const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(moment, Eigen::EigenvaluesOnly).eigenvalues();
      body.debris[i] = !(spread[0] > debris_below * spread[2]);
    }
  });
}

}  // namespace geo
