// Fewer faces where few will do, for interactive use (§ 5.2).
#pragma once

#include <span>

#include "crack/advance.h"

namespace geo {

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
/// contacts of `fronts` stay or are left out between their neighbours. K never crosses itself, the derived surface stays
/// closed; volumes change by what the deviation allows. Cost follows the whole. Returns what changed.
/// Throws InputError for options out of range.
CrackDelta decimate(Complex& complex, std::span<FrontState* const> fronts, const DecimateOptions& options = {}, DecimateWork* work = nullptr);

}  // namespace geo
