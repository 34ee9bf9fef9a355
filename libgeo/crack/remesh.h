// Local remeshing of crack and skin after cuts (§ 5.2's merging of near points, § 8's first limitation).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "crack/advance.h"

namespace geo {

struct RemeshOptions {
  double angle = 15;          ///< degrees: faces with a smaller angle are improved
  double deviation = 1e-4;    ///< how far a crack's surface may move, relative to the extent's diagonal; the skin never does
  double shortest = 2e-3;     ///< no edge is divided into shorter ones, relative
  double crease = 20;         ///< degrees: an edge of a crack that is bent more is a feature
  /// Refuses what passes through a tetrahedron that this returns false for, where given (a body's nodes must keep their sides).
  std::function<bool(const std::array<Vec3, 4>&)> may_pass;
};

struct RemeshWork {
  std::size_t faces = 0, flips = 0, collapses = 0, moves = 0, divisions = 0, refused = 0;
  double seconds = 0;
};

/// Improves the faces of `region` (dead ones are skipped) that have a smaller angle than wanted, by flips, collapses,
/// moves and divisions. What must keep: the skin's surface (vertices stay on the triangles of the input that they lie
/// on), the lines where cracks meet each other and the skin, crack tips, creases, and the contacts of `fronts`, which
/// are followed where one is merged with its neighbour. Every edit is guarded: K never intersects itself. Cost follows
/// the region. Returns what changed in all. Throws InputError for options out of range.
CrackDelta remesh(Complex& complex, std::span<const FaceId> region, std::span<FrontState* const> fronts,
                  const RemeshOptions& options = {}, RemeshWork* work = nullptr);

/// The smallest angle of a triangle, in degrees.
double smallest_angle(const std::array<Vec3, 3>& corners);

}  // namespace geo
