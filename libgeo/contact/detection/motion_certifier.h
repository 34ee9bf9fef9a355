// Certification of straight motions: pairs of triangles that may pass through each other.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/surface_motion.h"
#include "contact/detection/triangle_planes.h"
#include "contact/detection/vertex_fans.h"

namespace geo {

/// Certifies that pairs of triangles do not cross at the end of a straight motion and do not pass
/// through each other on the way. At the start no triangles cross. The end may change from call to
/// call.
class MotionCertifier {
 public:
  /// Indices of two triangles.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// Whether two triangles without a common vertex, at this distance at the start, are known not to
  /// pass through each other.
  using KnownDisjoint = std::function<bool(std::uint32_t s, std::uint32_t t, double distance)>;
  /// The data of a motion. All references must outlive the certifier.
  struct Motion {
    const RepresentativeSurface& surface;
    const VertexFans& fans;                         ///< of the surface itself
    std::span<const std::uint32_t> representative;  ///< coincident_representatives()
    bool two_sided;                                 ///< as in triangles_cross()
    const std::vector<Vec3>& start;                 ///< positions at the start
    const std::vector<Vec3>& next;                  ///< positions at the end
    double rounding;                                ///< error bound of separations, model units
  };
  /// Computes `planes` for the motion and uses them from then on.
  MotionCertifier(const Motion& motion, TrianglePlanes& planes);

  /// The uncertified pairs, ascending: pairs that cross at the end by the exact test, or that may
  /// pass through each other. A pair is certified if one axis separates it at both ends, or if it
  /// is known to be disjoint and does not cross at the end. `pairs`: the pairs without a common
  /// vertex of the surface whose boxes meet; pairs with a common vertex are tested in addition.
  /// Tests only pairs with a triangle marked in `changed`, which marks all triangles whose end
  /// differs from the previous call. At the first call all must be marked, and the end must be
  /// that of the construction.
  std::vector<Pair> uncertified_pairs(std::span<const Pair> pairs, const std::vector<std::uint8_t>& changed,
                                      const KnownDisjoint& known_disjoint);

 private:
  void certify(std::span<const Pair> pairs, const std::vector<std::uint8_t>& changed,
               const KnownDisjoint& known_disjoint, std::vector<Pair>& uncertified) const;
  void update_planes(const std::vector<std::uint8_t>& changed);

  Motion m_;
  TrianglePlanes& planes_;
  std::vector<std::uint8_t> certified_fans_;  // per vertex: VertexFans::find_uncertified() at the end
  bool planes_current_ = true;                // as computed by the constructor
};

}  // namespace geo
