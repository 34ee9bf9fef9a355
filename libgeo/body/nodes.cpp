#include "body/nodes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/random.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"
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
  // A crack is a boundary, and an octree's leaves halve at most from one to the next: half of what
  // the nearest node to each cell of a lattice has, which is as fine as nodes usually are. Of the
  // nodes that the body was built of: else each step would halve anew.
  const double cell = body.grid.cell();
  std::map<std::array<double, 3>, double> found;
  const auto spacing_at = [&](const Vec3& x) {
    if (spacing > 0) return spacing;
    const std::array<double, 3> at{std::floor(x[0] / cell), std::floor(x[1] / cell), std::floor(x[2] / cell)};
    const auto [place, fresh] = found.try_emplace(at, 0);
    if (fresh) {
      const double there =
          body.nodes.spacing[body.grid.nearest(body.nodes.position, cell * (Vec3(at.data()) + Vec3::Constant(0.5)), 1,
                                               ~0u, [&](std::uint32_t i) { return i < body.sampled; })[0]];
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
    Box3 around{s.position, s.position};
    for (const auto i : nearest) around.add(body.nodes.position[i]);
    const SightIn sight(body.surface, around);
    std::vector<std::uint32_t> seen;
    for (const auto i : nearest)
      if (seen.size() < 12 && !sight.blocked(body.nodes.position[i], s.position)) seen.push_back(i);
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

namespace {

// The direction whose least part along all of `normals` is about the greatest: between two faces
// half way, in a corner along its axis.
Vec3 away_from(const std::vector<Vec3>& normals) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& n : normals) sum += n;
  for (int i = 0; normals.size() > 1 && i < 64; ++i)
    sum += *std::min_element(normals.begin(), normals.end(),
                             [&](const Vec3& a, const Vec3& b) { return a.dot(sum) < b.dot(sum); });
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : normals[0];
}

// A better place for the node that rounding or a cut has put on or very near some of the faces
// around it: where it is, if there is none.
Vec3 place_off(const Complex& surface, std::uint32_t node, const Vec3& x, double spacing) {
  const double close = 0.02 * spacing, most = 0.1 * spacing;
  std::vector<FaceId> around;
  surface.faces_near(Box3{x, x}.grown(most + close), around);
  const auto distance = [&](FaceId f, const Vec3& p) {
    const auto t = surface.corners(f);
    return (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
  };
  // Away from all that are close at once: what goes straight away from one may pass another. On a
  // face either side will do.
  std::array<std::vector<Vec3>, 2> normals;
  double clear = most;
  for (const FaceId f : around) {
    const double d = distance(f, x);
    if (d > close) continue;
    clear = std::min(clear, d);
    const auto t = surface.corners(f);
    const int above = orient3d(t[0], t[1], t[2], x);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    normals[0].push_back(above < 0 ? Vec3(-n) : n), normals[1].push_back(above > 0 ? n : Vec3(-n));
  }
  if (normals[0].empty()) return x;
  const auto on = std::partition(around.begin(), around.end(), [&](FaceId f) { return !touches(surface, f, x, x); });
  if (on != around.end()) clear = -1;  // any place is better
  std::vector<Vec3> ways{away_from(normals[0]), away_from(normals[1])};
  for (const auto& side : normals) ways.insert(ways.end(), side.begin(), side.end());
  for (Random random(node); ways.size() < 2 * normals[0].size() + 16;) ways.push_back(random.direction());
  // As far as there is room. The faces that it is on are left behind, no other is passed.
  Vec3 best = x;
  for (const Vec3& along : ways)
    for (double step = most; step > 1e-6 * spacing; step *= 0.5) {
      const Vec3 to = x + step * along;
      if (std::any_of(around.begin(), on, [&](FaceId f) { return touches(surface, f, x, to); }) ||
          std::any_of(on, around.end(), [&](FaceId f) { return touches(surface, f, x + 1e-3 * step * along, to); }))
        continue;
      double least = most;
      for (const FaceId f : around) least = std::min(least, distance(f, to));
      if (least > clear) clear = least, best = to;
      if (clear > close) return best;
      break;
    }
  return best;
}

}  // namespace

std::vector<NodeId> move_off(Body& body, const std::vector<FaceId>& faces) {
  std::vector<std::uint32_t> near;
  for (const FaceId f : faces) {
    const auto t = body.surface.corners(f);
    // Those in cubes along the face: the ball about a large one would be the whole body.
    body.grid.walk(
        [&](int, const Vec3& middle, double half) {
          const double reach = std::numbers::sqrt3 * half + 0.1 * body.grid.cell();
          return (closest_point_on_triangle(middle, t[0], t[1], t[2]) - middle).squaredNorm() <= reach * reach;
        },
        [&](int, std::uint32_t i) {
          const Vec3& x = body.nodes.position[i];
          if ((closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() <= 0.02 * body.nodes.spacing[i])
            near.push_back(i);
        });
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<NodeId> moved;
  for (const auto i : near) {
    const Vec3 from = body.nodes.position[i], to = place_off(body.surface, i, from, body.nodes.spacing[i]);
    if (to == from) continue;
    body.grid.erase(i, from);
    body.nodes.position[i] = to;
    body.grid.insert(body.nodes.position, i);
    moved.push_back(NodeId(i));
  }
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
