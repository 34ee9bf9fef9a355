// Occluders near the points that change. They are kept from cut to cut: a cut beside the last one
// adds its own faces to them.
#pragma once

#include <span>
#include <vector>

#include "kerf/complex.h"
#include "mechanics/discretisation/diffraction.h"

namespace geo {

/// Not thread-safe.
class NearbyOccluders {
 public:
  /// Notes that the surface has changed. `added`: faces that it gained.
  void note_changes(std::span<const FaceId> added);
  /// The living faces that meet one of the boxes, and others, with their front edges. A query for
  /// faces that are not known yet extends `margin` beyond the boxes. Larger: more faces, fewer
  /// queries.
  const Occluders& near(const Complex& surface, std::span<const Box3> boxes, double margin);

 private:
  Occluders occluders_;
  std::vector<FaceId> faces_;  // of occluders_, and those added since
  std::vector<Box3> known_;    // faces_ has all faces that meet these boxes
  bool stale_ = false;         // the surface has changed since occluders_ was computed
};

}  // namespace geo
