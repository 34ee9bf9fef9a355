// Ear clipping (Meisters 1975), with the exact orient2d along the dominant axis of the normal. An
// ear is a convex corner whose triangle contains no other corner; corners are tried cyclically.
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
  std::vector<std::uint32_t> rest(n);  // corners that are not cut off yet
  std::iota(rest.begin(), rest.end(), 0u);
  for (std::size_t i = 0, tried = 0; rest.size() > 3; ++i) {
    if (tried++ == rest.size()) return fan;  // it crosses itself, or has no area
    const std::size_t middle = i % rest.size();
    const auto a = rest[(middle + rest.size() - 1) % rest.size()], b = rest[middle],
               c = rest[(middle + 1) % rest.size()];
    const auto blocks_ear = [&](std::uint32_t d) {
      return polygon[d] != polygon[a] && polygon[d] != polygon[b] && polygon[d] != polygon[c] && turn(a, b, d) >= 0 &&
             turn(b, c, d) >= 0 && turn(c, a, d) >= 0;
    };
    if (turn(a, b, c) <= 0 || std::any_of(rest.begin(), rest.end(), blocks_ear)) continue;
    ears.push_back({a, b, c});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(middle));
    tried = 0;
  }
  ears.push_back({rest[0], rest[1], rest[2]});
  return ears;
}

}  // namespace geo
