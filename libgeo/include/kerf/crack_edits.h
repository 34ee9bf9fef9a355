// Local remeshing of crack and skin after cuts (§ 5.2's merging of near points, § 8's first limitation).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kerf/crack.h"

namespace geo {

struct RemeshOptions {
  double angle = 15;  ///< degrees: faces with a smaller angle are improved
  double deviation =
      1e-4;  ///< how far a crack's surface may move, relative to the extent's diagonal; the skin never does
  double shortest = 2e-3;  ///< no edge is divided into shorter ones, relative
  double crease = 20;      ///< degrees: an edge of a crack that is bent more is a feature
  /// Refuses what passes through a tetrahedron that this returns false for, where given (a body's nodes must keep their
  /// sides).
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

// ---- Jagged cracks (§ 5.2, brittle fracture): crack faces subdivided and displaced by fractal noise.

struct RoughenOptions {
  double amplitude = 0.01;  ///< of the largest bumps, relative to the extent's diagonal
  double frequency = 8;     ///< of these, per diagonal
  int octaves = 4;          ///< each twice as fine and 0.6 times as high
  double edge = 0;          ///< longest edge inside a crack, relative; 0: a twelfth of the largest bumps
  std::uint64_t seed = 1;
  std::vector<std::int32_t> cracks;  ///< which; empty: all
};

struct RoughenWork {
  std::size_t divisions = 0, moves = 0, lowered = 0,
              refused = 0;  ///< lowered: moved less far than wanted, for something is in the way
  double seconds = 0;
};

/// Divides the inner edges of the cracks and moves their inner vertices along the normal by noise that fades towards
/// the skin, other cracks and the tips, which stay as they are. Both sides of a crack are alike, the pieces' volumes
/// sum to what they did, and nothing crosses: where it would, a vertex moves less. Contacts of `fronts` stay. Returns
/// what changed. Throws InputError for options out of range.
CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options = {},
                   RoughenWork* work = nullptr);

/// Gradient noise (Perlin 2002) in about [−1, 1], the same for the same seed everywhere.
double noise(const Vec3& p, std::uint64_t seed);

// ---- Fewer faces where few will do, for interactive use (§ 5.2).

struct DecimateOptions {
  double deviation = 1e-3;  ///< how far the surface may be from where it was, relative to the extent's diagonal
  std::size_t faces = 0;    ///< no fewer live faces than this
  double crease = 30;       ///< degrees: edges that are bent more are kept as lines
  double angle = 5;         ///< degrees: no face gets a smaller angle, unless it had
};

struct DecimateWork {
  std::size_t collapses = 0, refused = 0;
  double seconds = 0;
};

/// Collapses edges of skin and cracks, the shortest first. Lines where surfaces meet, tips and creases stay lines;
/// contacts of `fronts` stay or are left out between their neighbours. K never crosses itself, the derived surface
/// stays closed; volumes change by what the deviation allows. Cost follows the whole. Returns what changed. Throws
/// InputError for options out of range.
CrackDelta decimate(Complex& complex, std::span<FrontState* const> fronts, const DecimateOptions& options = {},
                    DecimateWork* work = nullptr);

}  // namespace geo
