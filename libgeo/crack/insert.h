// One attempt to insert a strip into K: meet, split, classify, stitch, guard, commit (§ 5.2).
#pragma once

#include <optional>

#include "crack/arrangement.h"
#include "crack/pause.h"

namespace geo::crack {

/// Parameters of one attempt at a step, model units.
struct Attempt {
  double jitter;     ///< displacement of the new front: 0 in attempt 0, else options.jitter · 8^min(n − 1, 4)
  double clearance;  ///< see GuardContext; 0 in the later half of the attempts
};
/// The parameters of attempt `number`, for a complex of extent diagonal `size`.
Attempt attempt_at(int number, const CrackOptions& options, double size);

/// Inserts the parts of the strip in the material as faces of crack `crack` and returns the
/// changes; empty when no part is inside. `clearance`: see GuardContext; empty: without the guard,
/// see insert_unguarded(). `vertex` receives the vertex of each point of the arrangement that has
/// one. Throws GeometryError, K unchanged, when rounding would break K;
/// where the arrangement's pause throws, K is unchanged, too.
CrackDelta insert_strip(Complex& complex, const Strip& strip, Arrangement& arrangement, std::int32_t crack,
                        std::vector<VertexId>& vertex, std::optional<double> clearance, CrackStats& stats);

/// As insert_sheet(), in one attempt and without the guard: the faces and how they are joined are
/// exact, but rounded coordinates may make faces cross. For counts of pieces, not for output. Where
/// `pause` throws, K is unchanged.
void insert_unguarded(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const Pause& pause = {});

/// As insert_sheet(); where `pause` throws, K is unchanged.
CrackDelta insert_sheet_with_pauses(Complex& complex, const TriangleMesh& sheet, std::int32_t crack,
                                    const CrackOptions& options, CrackStats* stats, const Pause& pause);

}  // namespace geo::crack
