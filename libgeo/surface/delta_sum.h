// Sums consecutive deltas of a crack complex.
#pragma once

#include <unordered_map>
#include <unordered_set>

#include "kerf/complex.h"

namespace geo {

/// Accumulates consecutive deltas into one. Items that were made and removed again are in neither
/// list; lists are ascending.
class DeltaSum {
 public:
  /// Adds the delta that follows those added so far. Cost follows the delta.
  void add(const CrackDelta& delta);
  /// The sum of all deltas.
  CrackDelta sum() const;

 private:
  std::vector<VertexId> new_vertices_;
  std::unordered_set<FaceId> removed_faces_, new_faces_, new_crack_faces_;
  std::unordered_set<SurfaceVertexId> removed_, touched_;
  std::unordered_map<SurfaceVertexId, SurfaceVertexId> new_;  // with what each is a copy of
};

}  // namespace geo
