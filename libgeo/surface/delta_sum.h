// Many deltas, one after the other, as one.
#pragma once

#include <unordered_map>
#include <unordered_set>

#include "kerf/complex.h"

namespace geo {

/// What was made and removed again is in neither list; what is left is listed in ascending order.
class DeltaSum {
 public:
  /// Cost follows the delta added.
  void add(const CrackDelta& delta);
  CrackDelta sum() const;

 private:
  std::vector<VertexId> new_vertices_;
  std::unordered_set<FaceId> removed_faces_, new_faces_, new_crack_faces_;
  std::unordered_set<SurfaceVertexId> removed_, touched_;
  std::unordered_map<SurfaceVertexId, SurfaceVertexId> new_;  ///< to what each is a copy of
};

}  // namespace geo
