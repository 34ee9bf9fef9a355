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

// g · d for a pseudo-random gradient g at the lattice point with this hash. g is one of the twelve
// midpoints of the edges of the cube [−1, 1]³; four of them occur twice, so that four bits choose
// (Perlin 2002).
double gradient(std::uint64_t lattice, std::uint64_t seed, const Vec3& d) {
  const auto bits = mixed(seed ^ lattice) & 15;
  const double u = bits < 8 ? d.x() : d.y(), v = bits < 4 ? d.y() : bits == 12 || bits == 14 ? d.x() : d.z();
  return (bits & 1 ? -u : u) + (bits & 2 ? -v : v);
}

// Noises that differ in their seeds alone: corners, weights and hashes of corners are shared.
template <std::size_t count>
std::array<double, count> noises(const Vec3& p, const std::array<std::uint64_t, count>& seeds) {
  const Vec3 base = p.array().floor();
  const Vec3 d = p - base;
  double weight[3][2];  // fade curve 6 t⁵ − 15 t⁴ + 10 t³: its first two derivatives vanish at 0 and 1
  std::uint64_t lattice[3][2];
  for (int i = 0; i < 3; ++i) {
    weight[i][1] = d[i] * d[i] * d[i] * (d[i] * (d[i] * 6 - 15) + 10);
    weight[i][0] = 1 - weight[i][1];
    for (int end = 0; end < 2; ++end) lattice[i][end] = static_cast<std::uint64_t>(std::llround(base[i] + end));
  }
  std::array<double, count> sum{};
  for (int z = 0; z < 2; ++z) {
    const std::uint64_t hash_z = mixed(lattice[2][z]);
    for (int y = 0; y < 2; ++y) {
      const std::uint64_t hash_y = mixed(lattice[1][y] ^ hash_z);
      for (int x = 0; x < 2; ++x) {
        const std::uint64_t hash_x = mixed(lattice[0][x] ^ hash_y);
        const double w = weight[0][x] * weight[1][y] * weight[2][z];
        const Vec3 from_corner = d - Vec3(x, y, z);
        for (std::size_t s = 0; s < count; ++s) sum[s] += w * gradient(hash_x, seeds[s], from_corner);
      }
    }
  }
  return sum;
}

}  // namespace

double gradient_noise(const Vec3& p, std::uint64_t seed) { return noises<1>(p, {seed})[0]; }

std::array<double, 3> gradient_noises(const Vec3& p, const std::array<std::uint64_t, 3>& seeds) {
  return noises(p, seeds);
}

}  // namespace geo
