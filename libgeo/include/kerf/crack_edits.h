// Local edits of a crack complex: remeshing, roughening by noise, decimation (§ 5.2, § 8's first
// limitation).
//
// Each edit is guarded: K never intersects itself and S_A stays closed. Vertices stay on all that
// they lie on: the skin as given, the cracks, and the feature lines where these meet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kerf/crack.h"

namespace geo {

// ---- Remeshing

/// Lengths are relative to the diagonal of Complex::extent().
struct RemeshOptions {
  double angle = 15;        ///< degrees: faces with a smaller angle are improved
  double deviation = 1e-4;  ///< how far a crack's surface may move in one edit; the skin never does
  double shortest = 2e-3;   ///< no edge is divided into shorter ones
  double crease = 20;       ///< degrees: an edge of a crack with a larger dihedral deviation is a feature
  /// Where given: refuses edits whose faces sweep a tetrahedron for which this is false (a body's
  /// nodes must stay on their sides of a crack).
  std::function<bool(const std::array<Vec3, 4>&)> may_sweep;
};

struct RemeshStats {
  /// faces: bad faces examined, again each time; then the edits made, by kind.
  std::size_t faces = 0, flips = 0, collapses = 0, moves = 0, divisions = 0;
  std::size_t refused = 0;  ///< edits that the guard or may_sweep refused
  double seconds = 0;
};

/// Improves the faces of `region` (dead ones are skipped) that have a smaller angle than wanted, by
/// flips, collapses, moves and divisions. Kept are the skin's surface, the lines where cracks meet
/// each other and the skin, crack tips, creases, and the contacts of `fronts`. A contact merged
/// with its neighbour is removed from its front. Cost follows the region. Returns all changes.
/// Throws InputError for options out of range.
CrackDelta remesh(Complex& complex, std::span<const FaceId> region, std::span<FrontState* const> fronts,
                  const RemeshOptions& options = {}, RemeshStats* stats = nullptr);

/// The smallest angle of a triangle, in degrees.
double smallest_angle(const std::array<Vec3, 3>& corners);

// ---- Roughening: jagged cracks of brittle fracture

/// Lengths are relative to the diagonal of Complex::extent().
struct RoughenOptions {
  double amplitude = 0.01;  ///< of the largest bumps
  double frequency = 8;     ///< of the largest bumps, per diagonal
  int octaves = 4;          ///< each twice as fine and 0.6 times as high
  double edge = 0;          ///< longest edge inside a crack; 0: 1 / (12 · frequency)
  std::uint64_t seed = 1;
  std::vector<std::int32_t> cracks;  ///< numbers of the cracks to roughen; empty: all
};

struct RoughenStats {
  std::size_t divisions = 0;
  std::size_t moves = 0;    ///< inner vertices
  std::size_t lowered = 0;  ///< vertices that moved less far than wanted: something is in the way
  std::size_t refused = 0;  ///< divisions that the guard refused
  double seconds = 0;
};

/// Divides the inner edges of the cracks and displaces their inner vertices along the normal by
/// fractal noise. The noise fades towards the skin, other cracks and the tips, which stay. Both
/// sides of a crack stay alike and the volumes of the pieces keep their sum. A vertex moves less
/// where it would make faces cross. Contacts of `fronts` stay. Returns all changes. Throws
/// InputError for options out of range.
CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options = {},
                   RoughenStats* stats = nullptr);

// ---- Decimation: fewer faces for interactive use

struct DecimateOptions {
  double deviation = 1e-3;  ///< how far the surface may move, relative to the diagonal of Complex::extent()
  std::size_t faces = 0;    ///< no fewer living faces than this
  double crease = 30;       ///< degrees: edges with a larger dihedral deviation are kept as lines
  double angle = 5;         ///< degrees: no face gets a smaller angle unless it had one
};

struct DecimateStats {
  std::size_t collapses = 0;
  std::size_t refused = 0;  ///< collapses that the guard refused
  double seconds = 0;
};

/// Collapses edges of skin and cracks, the shortest first. Lines where surfaces meet, tips and
/// creases stay lines; contacts of `fronts` stay, or are omitted between their neighbours. Volumes
/// change within the deviation. Cost follows the whole complex. Returns all changes. Throws
/// InputError for options out of range.
CrackDelta decimate(Complex& complex, std::span<FrontState* const> fronts, const DecimateOptions& options = {},
                    DecimateStats* stats = nullptr);

}  // namespace geo
