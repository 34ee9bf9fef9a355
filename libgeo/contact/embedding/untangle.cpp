// Projection of separation constraints, Gauss–Seidel (position-based dynamics). The axis is the
// difference of closest points in the material, mapped by F⁻ᵀ; crossings are then searched again.
#include "contact/embedding/untangle.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <set>

#include "contact/detection/simplex.h"

namespace geo {
namespace {

// A pair of disjoint sub-simplices of triangles that have crossed.
struct SeparationConstraint {
  Simplex a, b;
  Vec3 normal;        // unit, from b to a
  double separation;  // wanted along the normal
};

// Moves vertices of a to n · x ≥ m + h and vertices of b to n · x ≤ m − h. Here m is the middle of
// the overlap, and h = 0.55 separation. Returns whether the constraint was violated.
bool project(const SeparationConstraint& c, std::vector<Vec3>& at, std::vector<std::uint8_t>& moved) {
  if (separation_along(c.normal, c.a, c.b, at) >= c.separation) return false;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int k = 0; k < c.a.size; ++k) least = std::min(least, c.normal.dot(at[c.a.v[k]]));
  for (int k = 0; k < c.b.size; ++k) most = std::max(most, c.normal.dot(at[c.b.v[k]]));
  const double plane = 0.5 * (least + most), half = 0.55 * c.separation;  // a tenth to spare
  const auto shift = [&](std::uint32_t v, double lack, double sign) {
    if (lack > 0) {
      at[v] += sign * lack * c.normal;
      moved[v] = 1;
    }
  };
  for (int k = 0; k < c.a.size; ++k) shift(c.a.v[k], plane + half - c.normal.dot(at[c.a.v[k]]), 1);
  for (int k = 0; k < c.b.size; ++k) shift(c.b.v[k], c.normal.dot(at[c.b.v[k]]) - plane + half, -1);
  return true;
}

// Appends the constraints of a pair of triangles of representatives. `start`: the given positions.
// `both_old`: neither triangle is fresh.
void add_constraints(const UntangleInput& in, const Triangle& s, const Triangle& t, bool both_old,
                     const std::vector<Vec3>& start, std::vector<SeparationConstraint>& out) {
  std::pair<Simplex, Simplex> pairs[2];
  const int count = disjoint_subsimplices(s, t, pairs);
  for (int i = 0; i < count; ++i) {
    const auto& [a, b] = pairs[i];
    const auto reference = [&](std::uint32_t v) { return both_old ? start[v] : in.rest(v); };
    Vec3 p[3], q[3];
    for (int k = 0; k < a.size; ++k) p[k] = reference(a.v[k]);
    for (int k = 0; k < b.size; ++k) q[k] = reference(b.v[k]);
    const Vec3 difference = closest_points(p, a.size, q, b.size).difference;
    Vec3 normal = difference;
    if (!both_old) {
      // Normals transform by the inverse transpose of the deformation gradient.
      Mat3 mean = Mat3::Zero();
      for (const Simplex& simplex : {a, b})
        for (int k = 0; k < simplex.size; ++k) mean += in.gradient(simplex.v[k]) / (a.size + b.size);
      normal = mean.inverse().transpose() * difference;
    }
    if (normal.norm() > 0 && normal.allFinite())
      // A quarter of the distance at the reference, at most the gap: less than the material allows.
      out.push_back(
          {.a = a, .b = b, .normal = normal.normalized(), .separation = std::min(in.gap, 0.25 * difference.norm())});
  }
}

}  // namespace

std::vector<TrianglePair> untangle(const UntangleInput& in, std::vector<Vec3>& positions,
                                   std::vector<std::uint8_t>& marked) {
  // Limits of effort: searches for crossings, and sweeps over the constraints after each search.
  // Larger: more attempts before the crack step is refused.
  constexpr int max_rounds = 16, max_sweeps = 4;
  const ContactSurface& surface = in.surface;
  const auto representative = coincident_representatives(surface.site, positions);
  const auto represented = [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    return Triangle{representative[a], representative[b], representative[c]};
  };
  std::vector<Vec3> start;  // the given positions; empty while nothing has crossed
  std::set<TrianglePair> known;
  std::size_t fewest = ~std::size_t(0);
  std::vector<SeparationConstraint> constraints;
  std::vector<std::uint8_t> moved;
  for (int round = 0;; ++round) {
    const auto crossings = find_crossings(surface.triangles, positions, representative, true, &marked);
    // In the second half of the rounds, gives up when crossings become more.
    fewest = std::min(fewest, crossings.size());
    if (crossings.empty() || round == max_rounds || (round >= max_rounds / 2 && crossings.size() > fewest))
      return crossings;
    if (start.empty()) {
      start = positions;
      moved.assign(positions.size(), 0);
    }
    for (const auto& pair : crossings)
      if (known.insert(pair).second)
        add_constraints(in, represented(pair.first), represented(pair.second),
                        !in.fresh[pair.first] && !in.fresh[pair.second], start, constraints);
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
      bool any = false;
      for (const SeparationConstraint& c : constraints) any |= project(c, positions, moved);
      if (!any) break;
    }
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = positions[representative[v]];
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const Triangle corners = represented(t);
      if (std::any_of(corners.begin(), corners.end(), [&](auto v) { return moved[v]; })) marked[t] = 1;
    }
  }
}

}  // namespace geo
