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
  double bending = 0;  ///< what bending adds to the normal traction where it adds most; not negative

  /// The traction that is compared with the strength: √(σ² + τ²) for a greatest tension σ and a
  /// shear τ. Under pressure, friction takes a part of the shear (Camacho and Ortiz 1996, with
  /// equal weights of tension and shear). `friction`: Coulomb's coefficient.
  double effective(double friction) const;
};

/// Finds tractions on the walls of bonds. The traction on a wall is the linear field along it that
/// fits P N best at the material points around: P the first Piola-Kirchhoff stress, N the wall's
/// normal. So it has the force and the moment of a beam's cross-section.
class BondLoads {
 public:
  /// Knows no points yet.
  BondLoads() = default;
  /// Takes the material points near each wall that see it: of all walls at first, and then of those
  /// near a new crack, or with other points near them. The solid's points are up to date; the
  /// result is that of a new BondLoads. `glued`: the same bonds in each call.
  void update(const Body& body, const Solid& solid, const GluedBonds& glued);
  /// The load on each bond; zero for broken ones, and where no point is near.
  std::vector<BondLoad> at(const Solid& solid, const State& state, const GluedBonds& glued) const;

 private:
  // The share of a point in the traction at a wall's centroid, and to its gradient along the
  // wall.
  struct Share {
    std::uint32_t near;   // the how manieth of the points around the wall it is
    std::uint32_t point;  // index into points_
    double mean;
    Vec2 slope;
  };
  // The place of a wall that is the nearest to a point.
  struct Sight {
    Vec3 point, from;
    double distance;  // the wall's reach where it is farther, or the point does not see it
  };
  struct Wall {
    std::uint64_t around = 0;   // hash of the points around
    double reach = 0;           // how far from the wall points count, model units
    std::vector<Sight> sights;  // of the points around
    std::vector<Share> shares;
    std::vector<Vec2> corners;  // about its centroid, in its plane
  };
  struct Point {
    std::uint32_t block, index;
  };
  // The nominal stress of a point, and the matrix that maps normals with their areas.
  struct PointStress {
    Mat3 nominal, area;
  };
  struct NearPoint;
  class Surroundings;
  static Wall wall_of(const std::vector<NearPoint>& near, const GluedBond& bond, const std::vector<Vec3>& corners);
  std::vector<PointStress> stresses(const Solid& solid, const State& state) const;

  std::vector<Point> points_;  // that some wall uses, by block
  std::vector<Wall> walls_;    // by bond
  std::uint32_t faces_ = 0;    // of the complex at the last update: newer ones have higher ids
};

}  // namespace geo
