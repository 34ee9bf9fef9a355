// The beam that mechanics are measured on: 4 × 1 × 1, held at one end, bending under its own
// weight.
#pragma once

#include <cstddef>

namespace bench {

struct Beam {
  int across = 10;  ///< cells across its section
  double young = 2e5, poisson = 0.3, density = 1000, gravity = 1, dt = 1.0 / 30;
  int frames = 30;
};

struct Bent {
  std::size_t nodes = 0;
  double seconds = 0;  ///< CPU time of all frames, one thread
  double tip = 0;      ///< mean displacement of its end at last, m
};

Bent bend_with_bullet(const Beam& beam);

}  // namespace bench
