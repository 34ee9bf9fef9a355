#include "surface/polygon.h"

#include <algorithm>
#include <numeric>

#include "geometry/predicates.h"

namespace geo {

std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<Vec3>& vertices,
                                                       const std::vector<std::uint32_t>& polygon) {
  const auto n = static_cast<std::uint32_t>(polygon.size());
  std::vector<std::array<std::uint32_t, 3>> fan, ears;
  for (std::uint32_t k = 1; k + 1 < n; ++k) fan.push_back({0, k, k + 1});
  if (n == 3) return fan;
  const auto at = [&](std::uint32_t corner) -> const Vec3& { return vertices[polygon[corner]]; };
  Vec3 normal = Vec3::Zero();
  for (const auto& [a, b, c] : fan) normal += (at(b) - at(a)).cross(at(c) - at(a));
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  if (!normal.allFinite() || normal[axis] == 0) return fan;
  const int sense = normal[axis] > 0 ? 1 : -1;
  const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return sense * orient2d(at(a), at(b), at(c), axis);
  };
  if (std::all_of(fan.begin(), fan.end(), [&](const auto& t) { return turn(t[0], t[1], t[2]) > 0; })) return fan;
  std::vector<std::uint32_t> ring(n);
  std::iota(ring.begin(), ring.end(), 0u);
  for (std::size_t i = 0, tried = 0; ring.size() > 3; ++i) {
    if (tried++ == ring.size()) return fan;  // it crosses itself, or has no area
    const std::size_t middle = i % ring.size();
    const auto a = ring[(middle + ring.size() - 1) % ring.size()], b = ring[middle],
               c = ring[(middle + 1) % ring.size()];
    const auto in_the_way = [&](std::uint32_t d) {
      return polygon[d] != polygon[a] && polygon[d] != polygon[b] && polygon[d] != polygon[c] && turn(a, b, d) >= 0 &&
             turn(b, c, d) >= 0 && turn(c, a, d) >= 0;
    };
    if (turn(a, b, c) <= 0 || std::any_of(ring.begin(), ring.end(), in_the_way)) continue;
    ears.push_back({a, b, c});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(middle));
    tried = 0;
  }
  ears.push_back({ring[0], ring[1], ring[2]});
  return ears;
}

}  // namespace geo
