// The load on glued bonds: tractions on their walls, from the stress of the material points around
// them.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/body.h"
#include "kerf/glue.h"
#include "kerf/solid.h"

namespace geo {

/// Nominal traction on the wall of a bond (force over undeformed area), Pa.
struct BondLoad {
  double normal = 0;   ///< mean across the wall; positive: tension
  double shear = 0;    ///< mean along the wall
  double bending = 0;  ///< what bending adds to the normal traction at the edge of the wall; not negative

  /// The traction that is compared with the strength: √(σ² + τ²), with σ the greatest tension, and
  /// τ the shear. Under pressure, friction takes a part of the shear and tension takes none
  /// (Camacho and Ortiz 1996).
  double effective(double friction) const;
};

/// Weights of material points for each bond. A traction is the linear field along the wall that fits
/// P N best at the points near it: P the first Piola-Kirchhoff stress, N the wall's normal.
class BondLoads {
 public:
  /// Finds the material points within a node spacing of each bond that sees them.
  BondLoads(const Body& body, const Solid& solid, const GluedBonds& glued);
  /// The load on each bond; zero for broken ones, and where no point is near.
  std::vector<BondLoad> at(const Solid& solid, const State& state, const GluedBonds& glued) const;

 private:
  struct Sample {
    std::uint32_t point;       // index into points_
    double mean;               // weight of the traction at the centroid
    Vec2 slope;                // of its gradient along the wall
  };
  struct Wall {
    std::vector<Sample> samples;
    std::vector<Vec2> corners;  // of the wall about its centroid, in its plane: the hull's extremes
  };
  struct Point {
    std::uint32_t block, index;
  };
  std::vector<Point> points_;  // that some bond uses, by block
  std::vector<Wall> walls_;
};

}  // namespace geo
