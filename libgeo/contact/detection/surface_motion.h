// The motion of a surface in one step: input of detection and of collision-free motion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Positions at the start of a step, where no two triangles cross, and wanted positions at its end.
/// Refers to data of the caller.
struct SurfaceMotion {
  const std::vector<Triangle>& triangles;         ///< of surface vertices
  std::span<const std::uint32_t> representative;  ///< per vertex: coincident_representatives()
  const std::vector<Vec3>& from;                  ///< per vertex: position at the start
  const std::vector<Vec3>& to;                    ///< per vertex: wanted position at the end
  double gap = 0;                                 ///< distance that surfaces in contact keep, model units
  double reach = 0;                               ///< distance below which a pair is a contact candidate, model units
  /// If given: positions near `to` that are less likely to cross. They become the end if they are
  /// certified.
  const std::vector<Vec3>* guess = nullptr;
  /// Per vertex: 1 where it stays at `from`, as `to` and `guess` say, too. Empty: none does.
  std::span<const std::uint8_t> still = {};
};

/// Per triangle: 1 where a vertex is not still. `still`: as SurfaceMotion::still; empty: the result
/// is empty, too.
inline std::vector<std::uint8_t> moving_triangles(const std::vector<Triangle>& triangles,
                                                  std::span<const std::uint8_t> still) {
  std::vector<std::uint8_t> moving(still.empty() ? 0 : triangles.size());
  for (std::size_t t = 0; t < moving.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    moving[t] = !still[a] || !still[b] || !still[c];
  }
  return moving;
}

/// A share of the straight motion of some vertices from `start` to `end`; the others stay. A share
/// of 0 does not read `end`.
inline std::vector<Vec3> share_of_motion(std::span<const std::uint32_t> vertices, const std::vector<Vec3>& start,
                                         const std::vector<Vec3>& end, double share) {
  std::vector<Vec3> part = start;
  if (share > 0)
    for (const auto v : vertices) part[v] = share < 1 ? Vec3(start[v] + share * (end[v] - start[v])) : end[v];
  return part;
}

/// The surface of a motion in terms of representatives: coincident vertices are one vertex.
struct RepresentativeSurface {
  /// Represents the surface of `motion`.
  explicit RepresentativeSurface(const SurfaceMotion& motion);

  std::vector<Triangle> triangles;      ///< of representatives
  std::vector<std::uint32_t> vertices;  ///< representatives in use, ascending
  /// Per triangle: has a vertex that represents several. Only such triangles can share a
  /// representative without sharing a surface vertex.
  std::vector<std::uint8_t> has_coincident;
  Vec3 target_centroid = Vec3::Zero();  ///< mean of the wanted positions

  /// Whether two triangles that share no vertex of the surface share a representative.
  bool share_representative(std::size_t s, std::size_t t) const {
    if (!has_coincident[s] || !has_coincident[t]) return false;
    const auto in_t = [&, of = triangles[t]](std::uint32_t v) { return v == of[0] || v == of[1] || v == of[2]; };
    return in_t(triangles[s][0]) || in_t(triangles[s][1]) || in_t(triangles[s][2]);
  }

  /// The box that triangle t sweeps on straight paths, relative to target_centroid.
  Box3 swept_box(std::size_t t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) const {
    Box3 box;
    for (const auto v : triangles[t]) {
      box.add(from[v] - target_centroid);
      box.add(to[v] - target_centroid);
    }
    return box;
  }
};

}  // namespace geo
