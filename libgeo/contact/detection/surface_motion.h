// What a step is about: where the vertices of a surface are at its beginning and want to be at its end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Triangles of rows, for each row the one that stands for it (vertices_together()), and where all are at the
/// beginning, where no two triangles cross, and want to be at the end.
struct SurfaceMotion {
  const std::vector<Triangle>& triangles;
  std::span<const std::uint32_t> together;
  const std::vector<Vec3>&from, &to;
  double gap = 0;                            ///< that sheets in contact keep
  double reach = 0;                          ///< pairs that come closer than this are watched
  const std::vector<Vec3>* guess = nullptr;  ///< where given: near `to`, and less likely to be in each other's way;
                                             ///< taken as the end if nothing fails there
};

/// The same in rows that stand for others.
struct StandingRows {
  explicit StandingRows(const SurfaceMotion& motion);
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> rows;   ///< of all triangles, ascending
  std::vector<std::uint8_t> joined;  ///< per triangle: a corner stands for others, so that it may be one of a triangle
                                     ///< that shares none on the surface
  Vec3 middle = Vec3::Zero();        ///< of where they want to be

  /// Whether two triangles that share no corner on the surface have one in common.
  bool touch(std::size_t s, std::size_t t) const {
    if (!joined[s] || !joined[t]) return false;
    const auto in_t = [&, of = triangles[t]](std::uint32_t v) { return v == of[0] || v == of[1] || v == of[2]; };
    return in_t(triangles[s][0]) || in_t(triangles[s][1]) || in_t(triangles[s][2]);
  }

  /// The box of what triangle t passes through on straight ways, relative to the middle.
  Box3 swept(std::size_t t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) const {
    Box3 box;
    for (const auto v : triangles[t]) box.add(from[v] - middle), box.add(to[v] - middle);
    return box;
  }
};

}  // namespace geo
