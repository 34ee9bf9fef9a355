// The guard before a commit: what rounding must not have done.
#pragma once

#include <span>
#include <string>

#include "kerf/complex.h"

namespace geo {

/// Where a vertex is after an edit of K as it is.
inline const Vec3& point_after(const Complex& complex, const ComplexEdit& edit, VertexId v) {
  return v.value < complex.vertex_count() ? complex.point(v) : edit.new_vertices[v.value - complex.vertex_count()];
}

/// New faces that come from one triangle, which therefore lie in its plane but for rounding.
struct Family {
  std::array<Vec3, 3> plane;     ///< the triangle's corners
  std::uint32_t first, end;      ///< edit.new_faces[first..end)
  std::span<const FaceId> near;  ///< faces of K that may be near; empty: they are looked up
  bool whole;                    ///< they cover the triangle, or those that are left out do not turn over either
};

/// A piece of a front's line that leaves the material at a vertex; see exits.h.
struct Exit {
  VertexId from;
  Vec3 to;
  VertexId at;                   ///< the vertex at `to`, where the line comes back; else invalid
  std::span<const FaceId> near;  ///< faces of K that may be near
};

/// What is wrong with an edit.
struct Fault {
  std::string what;
  std::vector<std::uint32_t> faces;  ///< of edit.new_faces: those concerned
  explicit operator bool() const { return !what.empty(); }
};

/// Checks an edit against K as it is: every new face has the orientation of its family's triangle
/// and an area, no new vertex stands where another does, faces stand around edges as they are
/// listed, no new face crosses a near one, and exits are outside. Exact. `moved` says per new
/// vertex whether rounding moved it; faces that it has not touched are as exact decisions left them
/// (empty: all are asked about). Families list every new face once, in order. With a `clearance`,
/// features of cracks that do not touch must also be that far apart, exact faces' as well, since
/// some may be near what an earlier step has rounded: what is a few last places thick no later step
/// can round. Returns the first fault, none when all is well. Cost follows the edit.
Fault find_fault(const Complex& complex, const ComplexEdit& edit, std::span<const Family> families,
                 std::span<const std::uint8_t> moved, double clearance = 0, std::span<const Exit> exits = {});

/// Moves points that rounding has moved anyway by a few places more, where that takes a fault away.
/// Returns the fault that remains, none when all is well; `repairs` is raised when one was mended.
Fault repair(const Complex& complex, ComplexEdit& edit, std::span<const Family> families,
             std::span<const std::uint8_t> moved, double clearance, std::span<const Exit> exits, std::size_t& repairs);

}  // namespace geo
