#include "crack/noise.h"

#include <cmath>

namespace geo {
namespace {

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

// The scalar product of d with one of sixteen gradients, towards the midpoints of a cube's edges,
// at a lattice point.
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
  double weight[3];
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
