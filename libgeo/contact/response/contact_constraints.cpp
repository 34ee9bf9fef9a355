// For closest points a, b and normal n: depth = gap − n · (a − b) at the end of the motion.
// approach = max(0, n · (a − b) − gap) / dt at the start, or −share · max(0, depth) / dt.
#include "contact/response/contact_constraints.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "kerf/parallel.h"

namespace geo {
namespace {

SurfacePoint surface_point(const Simplex& s, const Vec3& weights) {
  SurfacePoint point{{}, {}, 0};
  for (int k = 0; k < s.size; ++k)
    if (weights[k] > 0) {
      point.vertex[point.size] = s.v[k];
      point.weight[point.size++] = weights[k];
    }
  return point;
}

// Identifies the two points of a constraint by the vertices that carry them, in either order.
using PointPairKey = std::array<std::uint32_t, 6>;

PointPairKey key_of(const SurfacePoint& a, const SurfacePoint& b) {
  PointPairKey key;
  key.fill(~0u);
  std::copy(a.vertex, a.vertex + a.size, key.begin());
  std::copy(b.vertex, b.vertex + b.size, key.begin() + 3);
  std::sort(key.begin(), key.begin() + 3);
  std::sort(key.begin() + 3, key.end());
  if (std::lexicographical_compare(key.begin() + 3, key.end(), key.begin(), key.begin() + 3))
    std::rotate(key.begin(), key.begin() + 3, key.end());
  return key;
}

// A constraint with its sort key: neighbouring triangles share points, and the pair of simplices
// decides which of equal constraints is kept.
struct KeyedConstraint {
  ContactConstraint constraint;
  std::pair<PointPairKey, PointPairKey> key;  // of the points; of the two simplices
};

void add_constraint(const ContactCandidate& candidate, const SurfaceMotion& motion, const ConstraintOptions& options,
                    std::vector<KeyedConstraint>& out) {
  const Simplex &a = candidate.a, &b = candidate.b;
  if (separation_along(candidate.normal, a, b, motion.to) >= candidate.gap + options.reach) return;
  const ClosestPoints& closest = candidate.closest;
  ContactConstraint c{.a = surface_point(a, closest.weights_a),
                      .b = surface_point(b, closest.weights_b),
                      .normal = candidate.normal,
                      .depth = 0,
                      .approach = 0};
  c.approach = std::max(0.0, candidate.normal.dot(closest.difference) - candidate.gap) / options.dt;
  Vec3 apart = Vec3::Zero();  // at the end of the motion
  for (int k = 0; k < c.a.size; ++k) apart += c.a.weight[k] * motion.to[c.a.vertex[k]];
  for (int k = 0; k < c.b.size; ++k) apart -= c.b.weight[k] * motion.to[c.b.vertex[k]];
  c.depth = candidate.gap - c.normal.dot(apart);
  if (options.share > 0) c.approach = -options.share * std::max(0.0, c.depth) / options.dt;
  out.push_back({c, {key_of(c.a, c.b), {a.v[0], a.v[1], a.v[2], b.v[0], b.v[1], b.v[2]}}});
}

}  // namespace

std::vector<ContactConstraint> contact_constraints(const std::vector<ContactCandidate>& candidates,
                                                   const SurfaceMotion& motion, const ConstraintOptions& options) {
  constexpr std::size_t chunk = 256;  // candidates; the result does not depend on it
  std::vector<std::vector<KeyedConstraint>> of_chunk((candidates.size() + chunk - 1) / chunk);
  parallel_for(of_chunk.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = s * chunk; i < std::min(candidates.size(), (s + 1) * chunk); ++i)
        add_constraint(candidates[i], motion, options, of_chunk[s]);
  });
  std::vector<const KeyedConstraint*> sorted;
  for (const auto& constraints : of_chunk)
    for (const auto& c : constraints) sorted.push_back(&c);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto* c, const auto* d) { return c->key < d->key; });
  std::vector<ContactConstraint> unique;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (i == 0 || sorted[i]->key.first != sorted[i - 1]->key.first) unique.push_back(sorted[i]->constraint);
  return unique;
}

void add_sheet_constraints(const CoincidentVertices& coincident, const std::vector<Vec3>& targets,
                           const std::vector<Vec3>& normals, double tolerance, const ConstraintOptions& options,
                           std::vector<ContactConstraint>& constraints) {
  for (std::size_t v = 0; v < coincident.size(); ++v)
    for (std::size_t i = 0; i < coincident[v].size(); ++i)
      for (std::size_t j = i + 1; j < coincident[v].size(); ++j) {
        const auto a = coincident[v][i], b = coincident[v][j];
        // The outward normal of b's side points to a's material.
        const Vec3 across = normals[b].normalized() - normals[a].normalized();
        if (!(across.norm() > 0.5)) continue;  // they do not face each other: normals less than 29° apart
        const Vec3 n = across.normalized();
        const double apart = n.dot(targets[a] - targets[b]);
        if (apart < -tolerance)
          constraints.push_back({.a = {{a}, {1}, 1},
                                 .b = {{b}, {1}, 1},
                                 .normal = n,
                                 .depth = -apart,
                                 .approach = options.share * apart / options.dt});
      }
}

std::vector<ContactConstraint> deepest_constraints(const std::vector<ContactConstraint>& constraints,
                                                   const SurfaceWeights& weights, std::size_t count) {
  const auto heaviest_node = [&](const SurfacePoint& point) {
    return weights.heaviest()[point.vertex[std::max_element(point.weight, point.weight + point.size) - point.weight]];
  };
  struct Entry {
    std::uint32_t low, high;  // the two nodes
    double depth;
    std::size_t index;  // of the constraint
  };
  std::vector<Entry> order(constraints.size());
  parallel_for(order.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto a = heaviest_node(constraints[i].a), b = heaviest_node(constraints[i].b);
      order[i] = {.low = std::min(a, b), .high = std::max(a, b), .depth = constraints[i].depth, .index = i};
    }
  });
  std::sort(order.begin(), order.end(), [](const Entry& p, const Entry& q) {
    return std::tie(p.low, p.high, q.depth, p.index) < std::tie(q.low, q.high, p.depth, q.index);
  });
  std::vector<std::size_t> kept;
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    if (order[i].low != order[first].low || order[i].high != order[first].high) first = i;
    if (i - first < count) kept.push_back(order[i].index);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<ContactConstraint> result;
  for (const auto i : kept) result.push_back(constraints[i]);
  return result;
}

}  // namespace geo
