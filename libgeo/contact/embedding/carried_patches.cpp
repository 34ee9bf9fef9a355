// Vertices of one patch are found by union of the corners of crossing triangles.
#include "contact/embedding/carried_patches.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <span>

#include "base/union_find.h"
#include "geometry/affine_fit.h"

namespace geo {
namespace {

// The affine map of these vertices from rest to the positions given.
Eigen::Affine3d map_of(const CrossedSurface& surface, std::span<const std::uint32_t> vertices) {
  // Extents below a thousandth of a patch's tell nothing of its strain across, as given positions
  // lie off by as much where it bends: there, the gradient at nodes is known better.
  constexpr double flat = 1e-3;
  Vec3 rest_mean = Vec3::Zero();
  Vec3 given_mean = Vec3::Zero();
  Mat3 gradient = Mat3::Zero();
  const double share = 1.0 / double(vertices.size());
  for (const std::uint32_t v : vertices) {
    rest_mean += share * surface.in.rest(v);
    given_mean += share * surface.given[v];
    gradient += share * surface.in.gradient(v);
  }
  Mat3 own = Mat3::Zero();
  Mat3 cross = Mat3::Zero();
  for (const std::uint32_t v : vertices) {
    const Vec3 x = surface.in.rest(v) - rest_mean;
    own += x * x.transpose();
    cross += (surface.given[v] - given_mean) * x.transpose();
  }
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = gradient + linear_fit(cross - gradient * own, own, flat * flat);
  map.translation() = given_mean - map.linear() * rest_mean;
  return map;
}

class PatchCarrier {
 public:
  explicit PatchCarrier(const CrossedSurface& surface)
      : surface_(surface), patches_(surface.given.size()), is_in_(surface.given.size(), 0) {}

  // Takes triangles that cross into patches. False where all were in one.
  bool take(const std::vector<TrianglePair>& crossings) {
    bool grows = false;
    for (const auto& [s, t] : crossings) {
      const std::uint32_t first = corner(s, 0);
      for (const std::uint32_t triangle : {s, t})
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = corner(triangle, k);
          grows |= !is_in_[v] || patches_.find(v) != patches_.find(first);
          is_in_[v] = 1;
          patches_.unite(v, first);
        }
    }
    return grows;
  }

  // Empty where a map turns material over, or a vertex would move too far.
  std::optional<CarriedPatches> carried(const std::vector<std::uint8_t>& marked) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t v = 0; v < is_in_.size(); ++v)
      if (is_in_[v]) members[patches_.find(v)].push_back(v);
    CarriedPatches result{.positions = surface_.given, .marked = marked};
    for (const auto& [patch, vertices] : members) {
      const Eigen::Affine3d map = map_of(surface_, vertices);
      if (!(map.linear().determinant() > 0)) return {};
      for (const std::uint32_t v : vertices) {
        result.positions[v] = map * surface_.in.rest(v);
        if (!((result.positions[v] - surface_.given[v]).norm() <= surface_.in.reach)) return {};
      }
    }
    for (std::size_t v = 0; v < is_in_.size(); ++v) result.positions[v] = result.positions[surface_.representative[v]];
    for (std::uint32_t t = 0; t < marked.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) result.marked[t] |= is_in_[corner(t, k)];
    return result;
  }

 private:
  std::uint32_t corner(std::uint32_t triangle, std::size_t k) const {
    return surface_.representative[surface_.in.surface.triangles[triangle][k]];
  }

  const CrossedSurface& surface_;
  UnionFind patches_;
  std::vector<std::uint8_t> is_in_;  // per representative
};

}  // namespace

std::optional<CarriedPatches> carry_patches(const CrossedSurface& surface, const std::vector<std::uint8_t>& marked) {
  // Limit of effort: as many times a patch takes in what it crosses.
  constexpr int max_rounds = 16;
  const std::vector<Triangle>& triangles = surface.in.surface.triangles;
  PatchCarrier carrier(surface);
  std::vector<TrianglePair> crossings = surface.crossings;
  for (int round = 0; round < max_rounds && carrier.take(crossings); ++round) {
    std::optional<CarriedPatches> result = carrier.carried(marked);
    if (!result) return {};
    // Copies of one site that were apart may be at one place now.
    const auto representative = coincident_representatives(surface.in.surface.site, result->positions);
    crossings = find_crossings(triangles, result->positions, representative, true, &result->marked);
    if (crossings.empty()) return result;
  }
  return {};
}

}  // namespace geo
