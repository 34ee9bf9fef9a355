// What contact is asked for, and what it took.
#pragma once

#include <cstddef>

namespace geo {

struct ContactOptions {
  double friction = 0.3;  ///< Coulomb's coefficient between surfaces of the body
  double gap = 1e-4;      ///< that open sheets keep, in mean edges of the surface
  double opening = 1e-2;  ///< how far Eq. 1 must have the two sides of a sheet apart before they part, in mean edges; along each other, three times
  double recovery = 0.3;  ///< share of the way back, in a step, for nodes whose surfaces have passed through each other
  int rounds = 2;         ///< of finding what touches and applying impulses
};

struct ContactWork {
  std::size_t watched = 0, touching = 0, in_zones = 0, opened = 0, held = 0;
  double lag = 0;             ///< largest distance of a vertex from where Eq. 1 has it, model units
  double seconds = 0;
  ContactWork& operator+=(const ContactWork& o);
};

}  // namespace geo
