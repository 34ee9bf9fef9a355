// Jagged cracks (§ 5.2, brittle fracture): crack faces subdivided and displaced by fractal noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "crack/advance.h"

namespace geo {

struct RoughenOptions {
  double amplitude = 0.01;    ///< of the largest bumps, relative to the extent's diagonal
  double frequency = 8;       ///< of these, per diagonal
  int octaves = 4;            ///< each twice as fine and 0.6 times as high
  double edge = 0;            ///< longest edge inside a crack, relative; 0: a twelfth of the largest bumps
  std::uint64_t seed = 1;
  std::vector<std::int32_t> cracks;  ///< which; empty: all
};

struct RoughenWork {
  std::size_t divisions = 0, moves = 0, lowered = 0, refused = 0;  ///< lowered: moved less far than wanted, for something is in the way
  double seconds = 0;
};

/// Divides the inner edges of the cracks and moves their inner vertices along the normal by noise that fades towards the
/// skin, other cracks and the tips, which stay as they are. Both sides of a crack are alike, the pieces' volumes sum to
/// what they did, and nothing crosses: where it would, a vertex moves less. Contacts of `fronts` stay. Returns what
/// changed. Throws InputError for options out of range.
CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options = {}, RoughenWork* work = nullptr);

/// Gradient noise (Perlin 2002) in about [−1, 1], the same for the same seed everywhere.
double noise(const Vec3& p, std::uint64_t seed);

}  // namespace geo
