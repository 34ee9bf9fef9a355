// Self-contact (§ 3.3): its options and statistics, and the crossings that it prevents.
#pragma once

#include <cstddef>
#include <memory>

#include "kerf/mesh.h"

namespace geo {

/// Parameters of contact between surfaces of the bodies. Lengths are in mean edge lengths of the
/// surface.
struct ContactOptions {
  double friction = 0.3;  ///< Coulomb's coefficient
  double gap = 1e-4;      ///< distance that opened sheets of a crack keep
  /// Two sheets of a crack separate where Eq. 1 has them this far apart along the normal, or three
  /// times as far tangentially. Smaller: sheets follow the noise of the mechanics and never rest.
  double opening = 1e-2;
  double recovery = 0.3;  ///< share of an interpenetration that a step removes, explicit steps only
  int rounds = 2;         ///< iterations of contact detection and impulses, explicit steps only
};

/// Statistics of contact, summed over steps.
struct ContactStats {
  std::size_t planes = 0;     ///< separating planes used
  std::size_t touching = 0;   ///< contacts with a force or an impulse
  std::size_t in_zones = 0;   ///< vertices moved in rigid impact zones
  std::size_t opened = 0;     ///< vertices of coincident sheets that separated
  std::size_t held = 0;       ///< steps in which the surface was not moved at all
  double tracking_error = 0;  ///< largest distance of a vertex from Eq. 1, model units
  double seconds = 0;         ///< of moving the surface, and of impulses
  /// Adds counts and seconds; keeps the larger tracking error.
  ContactStats& operator+=(const ContactStats& o);
};

// ---- Crossings of a deformed frame, or of a plain mesh. Exact.
//
// Two triangles cross if they have a common point other than shared vertices and edges. On a
// two-sided surface, copies of one site (a vertex of the crack complex) with equal coordinates, to
// the bit, count as one vertex. The two sides of a face with coincident corners touch, as in every
// new crack; they do not cross.

/// Counts the crossings of one surface after the other, such as the frames of a run. Faster than
/// count_crossings() if consecutive surfaces have the same triangles: fans and the tree of boxes
/// are then reused.
class CrossingCounter {
 public:
  /// A counter that has seen no surface.
  CrossingCounter();
  ~CrossingCounter();
  /// Takes the cache of the other counter, which must not be used afterwards.
  CrossingCounter(CrossingCounter&&) noexcept;
  /// As the move constructor.
  CrossingCounter& operator=(CrossingCounter&&) noexcept;

  /// The number of pairs of triangles that cross. No triangle may have a vertex twice.
  std::size_t count(const TriangleMesh& surface);

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

/// The number of pairs of triangles of one surface that cross, as CrossingCounter::count().
std::size_t count_crossings(const TriangleMesh& surface);

}  // namespace geo
