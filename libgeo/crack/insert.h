// One attempt to insert a strip: meet, split, keep, stitch, guard, commit.
#pragma once

#include "crack/arrangement.h"

namespace geo::crack {

/// What one of the attempts at a step is allowed, in model units: the first moves nothing, later
/// ones eight times as far each time, up to a few millionths; the later half does without
/// clearance.
struct Attempt {
  double jitter, clearance;
};
Attempt attempt_at(int number, const CrackOptions& options, double size);

/// Inserts what of the strip lies in the material as faces of this crack and returns what changed;
/// empty when nothing does. `clearance`: see find_fault(). `vertex` receives the vertex of each
/// point of the arrangement that has one. Throws GeometryError, K unchanged, when rounding would
/// break it.
CrackDelta insert_strip(Complex& complex, const Strip& strip, Arrangement& arrangement, std::int32_t crack,
                        std::vector<VertexId>& vertex, double clearance, CrackStats& work);

}  // namespace geo::crack
