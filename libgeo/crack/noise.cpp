// Gradient noise on the integer lattice (K. Perlin, Improving noise, 2002). Gradients are hashed
// from the cell's corner and a seed, instead of a permutation table. It displaces cracks
// (crack/roughen, score/jagged) and varies strength (simulation/strength).
#include "crack/noise.h"

#include <cmath>

namespace geo {
namespace {

// The finaliser of SplitMix64 (Steele, Lea and Flood 2014), without its increment.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

// g · d for a pseudo-random gradient g at lattice point (x, y, z). g is one of the twelve midpoints
// of the edges of the cube [−1, 1]³; four of them occur twice, so that four bits choose (Perlin
// 2002).
double gradient(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed, const Vec3& d) {
  const auto bits = mixed(seed ^ mixed(static_cast<std::uint64_t>(x) ^
                                       mixed(static_cast<std::uint64_t>(y) ^ mixed(static_cast<std::uint64_t>(z))))) &
                    15;
  const double u = bits < 8 ? d.x() : d.y(), v = bits < 4 ? d.y() : bits == 12 || bits == 14 ? d.x() : d.z();
  return (bits & 1 ? -u : u) + (bits & 2 ? -v : v);
}

}  // namespace

double gradient_noise(const Vec3& p, std::uint64_t seed) {
  const Vec3 base = p.array().floor();
  const Vec3 d = p - base;
  double weight[3];  // fade curve 6 t⁵ − 15 t⁴ + 10 t³: its first two derivatives vanish at 0 and 1
  for (int i = 0; i < 3; ++i) weight[i] = d[i] * d[i] * d[i] * (d[i] * (d[i] * 6 - 15) + 10);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at(corner & 1, corner >> 1 & 1, corner >> 2);
    double w = 1;
    for (int i = 0; i < 3; ++i) w *= at[i] > 0 ? weight[i] : 1 - weight[i];
    const Vec3 lattice = base + at;
    sum += w * gradient(std::llround(lattice.x()), std::llround(lattice.y()), std::llround(lattice.z()), seed, d - at);
  }
  return sum;
}

}  // namespace geo
