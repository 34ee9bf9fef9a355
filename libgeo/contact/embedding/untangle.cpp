// Projection of separation constraints, Gauss–Seidel (position-based dynamics), then a new search.
// The axis is the difference of closest points in the material, mapped by F⁻ᵀ. Where that fails,
// normals of features are axes, too; then patches are carried (carried_patches.h).
#include "contact/embedding/untangle.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "contact/detection/simplex.h"
#include "contact/embedding/carried_patches.h"
#include "geometry/distance.h"

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

// Two simplices with points of their own: the first three are corners of a, the others of b.
struct SimplexPair {
  Simplex a, b;
  std::array<Vec3, 6> at;

  const Vec3* corners_of_a() const { return at.data(); }
  const Vec3* corners_of_b() const { return at.data() + 3; }
  double separation(const Vec3& n) const { return separation_along(n, a, b, at); }
};

// The simplices of surface vertices a and b at `position` of these.
template <class Position>
SimplexPair pair_at(const Simplex& a, const Simplex& b, const Position& position) {
  SimplexPair pair{.a = {.v = {0, 1, 2}, .size = a.size}, .b = {.v = {3, 4, 5}, .size = b.size}, .at = {}};
  for (int k = 0; k < a.size; ++k) pair.at[pair.a.v[k]] = position(a.v[k]);
  for (int k = 0; k < b.size; ++k) pair.at[pair.b.v[k]] = position(b.v[k]);
  return pair;
}

// The axes of the separating-axis theorem: normals of triangles, products of edges; not unit
// vectors. Equal places in the list stand for the same features at any positions.
std::vector<Vec3> feature_axes(const SimplexPair& pair) {
  const auto edges = [](int size, const Vec3* p) {
    std::vector<Vec3> result;
    if (size > 1) result.push_back(p[1] - p[0]);
    if (size > 2) result.insert(result.end(), {p[2] - p[1], p[0] - p[2]});
    return result;
  };
  const std::vector<Vec3> of_a = edges(pair.a.size, pair.corners_of_a()),
                          of_b = edges(pair.b.size, pair.corners_of_b());
  std::vector<Vec3> axes;
  if (pair.a.size == 3) axes.push_back(of_a[0].cross(of_a[1]));
  if (pair.b.size == 3) axes.push_back(of_b[0].cross(of_b[1]));
  for (const Vec3& p : of_a)
    for (const Vec3& q : of_b) axes.push_back(p.cross(q));
  return axes;
}

// A direction from b to a that separates them at the reference, and how far apart they lie along it
// now. Zero: none is known.
struct SeparatingAxis {
  Vec3 normal = Vec3::Zero();
  double separation = -std::numeric_limits<double>::infinity();

  // Takes another direction if it has to move the simplices less.
  void offer(const Vec3& direction, const SimplexPair& now) {
    const Vec3 unit = direction.stableNormalized();
    if (!(unit.norm() > 0) || !unit.allFinite()) return;
    const double apart = now.separation(unit);
    if (apart <= separation) return;
    normal = unit;
    separation = apart;
  }
};

// Offers the axes of features that separate the simplices at the reference. Where both have a
// corner at one place there, the separation is 0 to the bit.
void offer_features(const SimplexPair& reference, const SimplexPair& now, SeparatingAxis& axis) {
  const std::vector<Vec3> before = feature_axes(reference), after = feature_axes(now);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double ahead = reference.separation(before[i]), behind = reference.separation(-before[i]);
    if (ahead >= 0 && behind < 0) axis.offer(after[i], now);
    if (behind >= 0 && ahead < 0) axis.offer(-after[i], now);
  }
}

// The height of a triangle, the length of an edge; infinite for a point.
double least_extent(int size, const Vec3* p) {
  if (size == 3) return height_of({p[0], p[1], p[2]});
  return size == 2 ? (p[1] - p[0]).norm() : std::numeric_limits<double>::infinity();
}

// A quarter of the distance at the reference, at most the gap: less than the material allows. Of
// the extents where they touch at the reference.
double wanted_separation(const SimplexPair& reference, double distance, double gap) {
  const double room = distance > 0 ? distance
                                   : std::min(least_extent(reference.a.size, reference.corners_of_a()),
                                              least_extent(reference.b.size, reference.corners_of_b()));
  return std::min(gap, 0.25 * room);
}

// Which directions may separate two triangles.
enum class Axes { of_distance, of_distance_and_features };

// Positions of surface vertices: as given, and after some sweeps.
struct Positions {
  const std::vector<Vec3>&start, &now;
};

// Appends the constraints of a pair of triangles of representatives. `both_old`: neither triangle
// is fresh.
void add_constraints(const UntangleInput& in, Axes axes, const Triangle& s, const Triangle& t, bool both_old,
                     const Positions& at, std::vector<SeparationConstraint>& out) {
  std::pair<Simplex, Simplex> pairs[2];
  const int count = disjoint_subsimplices(s, t, pairs);
  for (int i = 0; i < count; ++i) {
    const auto& [a, b] = pairs[i];
    const SimplexPair reference = pair_at(a, b, [&](std::uint32_t v) { return both_old ? at.start[v] : in.rest(v); });
    const SimplexPair now = pair_at(a, b, [&](std::uint32_t v) { return at.now[v]; });
    const Vec3 difference =
        closest_points(reference.corners_of_a(), a.size, reference.corners_of_b(), b.size).difference;
    SeparatingAxis axis;
    if (both_old) {
      axis.offer(difference, now);
    } else {
      // Normals transform by the inverse transpose of the deformation gradient.
      Mat3 mean = Mat3::Zero();
      for (const Simplex& simplex : {a, b})
        for (int k = 0; k < simplex.size; ++k) mean += in.gradient(simplex.v[k]) / (a.size + b.size);
      axis.offer(mean.inverse().transpose() * difference, now);
    }
    // Along a direction that noise has turned, large triangles overlap by far more than they cross.
    if (axes == Axes::of_distance_and_features) offer_features(reference, now, axis);
    if (axis.normal.isZero(0)) continue;
    out.push_back(
        {.a = a, .b = b, .normal = axis.normal, .separation = wanted_separation(reference, difference.norm(), in.gap)});
  }
}

// A surface that crosses itself where it was given.
struct Tangle {
  const UntangleInput& in;
  std::vector<std::uint32_t> representative;
  std::vector<Vec3> given;           // positions
  std::vector<std::uint8_t> marked;  // triangles
  std::vector<TrianglePair> crossings;
};

// untangle() with these axes. `positions`, `marked`: as given.
std::vector<TrianglePair> untangle_along(Axes axes, const Tangle& tangle, std::vector<Vec3>& positions,
                                         std::vector<std::uint8_t>& marked) {
  // Limits of effort: searches for crossings, and sweeps over the constraints after each search.
  // Larger: more attempts before the crack step is refused.
  constexpr int max_rounds = 16, max_sweeps = 4;
  const UntangleInput& in = tangle.in;
  const ContactSurface& surface = in.surface;
  const auto& representative = tangle.representative;
  const auto represented = [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    return Triangle{representative[a], representative[b], representative[c]};
  };
  std::set<TrianglePair> known;
  std::size_t fewest = tangle.crossings.size();
  std::vector<SeparationConstraint> constraints;
  std::vector<std::uint8_t> moved(positions.size(), 0);
  std::vector<TrianglePair> crossings = tangle.crossings;
  for (int round = 1;; ++round) {
    for (const auto& pair : crossings)
      if (known.insert(pair).second)
        add_constraints(in, axes, represented(pair.first), represented(pair.second),
                        !in.fresh[pair.first] && !in.fresh[pair.second], {.start = tangle.given, .now = positions},
                        constraints);
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
    crossings = find_crossings(surface.triangles, positions, representative, true, &marked);
    // In the second half of the rounds, gives up when crossings become more.
    fewest = std::min(fewest, crossings.size());
    if (crossings.empty() || round == max_rounds || (round >= max_rounds / 2 && crossings.size() > fewest))
      return crossings;
  }
}

}  // namespace

std::vector<TrianglePair> untangle(const UntangleInput& in, std::vector<Vec3>& positions,
                                   std::vector<std::uint8_t>& marked) {
  auto representative = coincident_representatives(in.surface.site, positions);
  auto crossings = find_crossings(in.surface.triangles, positions, representative, true, &marked);
  if (crossings.empty()) return crossings;
  const Tangle tangle{.in = in,
                      .representative = std::move(representative),
                      .given = positions,
                      .marked = marked,
                      .crossings = std::move(crossings)};
  const std::vector<TrianglePair> left = untangle_along(Axes::of_distance, tangle, positions, marked);
  if (left.empty()) return left;
  positions = tangle.given;
  marked = tangle.marked;
  std::vector<TrianglePair> still = untangle_along(Axes::of_distance_and_features, tangle, positions, marked);
  if (still.empty()) return still;
  const CrossedSurface crossed{
      .in = in, .representative = tangle.representative, .given = tangle.given, .crossings = tangle.crossings};
  std::optional<CarriedPatches> carried = carry_patches(crossed, tangle.marked);
  if (!carried) return still;
  positions = std::move(carried->positions);
  marked = std::move(carried->marked);
  return {};
}

}  // namespace geo
