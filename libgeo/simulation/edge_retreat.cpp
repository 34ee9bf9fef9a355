// Ahead of a front the nearest point of its sheet is on the front itself; behind it, inside the
// sheet. The ratio of the two distances is the sine of the angle between the way and the sheet.
#include "simulation/edge_retreat.h"

#include <algorithm>

#include "simulation/existing_cuts.h"
#include "simulation/mapped_places.h"

namespace geo {
namespace {

// Holds points whose neighbours in the material are held: one point that goes on alone, since the
// material trembles, folds the sheet. `solid`: the points in the material, ascending.
void hold_lone_points(const std::vector<std::size_t>& solid, std::vector<std::uint8_t>& held) {
  const std::vector<std::uint8_t> before = held;
  for (std::size_t k = 0; k < solid.size() && solid.size() > 1; ++k) {
    const bool left = k == 0 || before[solid[k - 1]], right = k + 1 == solid.size() || before[solid[k + 1]];
    if (left && right) held[solid[k]] = 1;
  }
}

}  // namespace

bool leads_back(const Complex& surface, const FrontState& front, const Vec3& from, const Vec3& to, double spacing) {
  const auto behind = [&](const Vec3& y, double slope) {
    const double ahead = distance_from_front(front, y);
    return ahead > 0 && distance_from_crack(surface, front.crack, y, beside_own_sheet * spacing) < slope * ahead;
  };
  // Half the way: a blade that is pulled out ends in air, but its way begins along the sheet.
  return behind(to, 0.5) || behind(0.5 * (from + to), 0.1);
}

std::size_t hold_retreating(const Complex& surface, const FrontState& front, std::span<const double> spacing,
                            std::vector<Vec3>& to) {
  const std::size_t n = front.points.size();
  std::vector<std::size_t> solid;  // points in the material
  std::vector<std::uint8_t> held(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!front.points[i].id.valid()) continue;
    solid.push_back(i);
    held[i] = leads_back(surface, front, front.points[i].position, to[i], spacing[i]);
  }
  if (solid.empty()) return 0;
  hold_lone_points(solid, held);
  for (std::size_t i = 0; i < n; ++i) {
    if (front.points[i].id.valid()) continue;
    const auto after = std::lower_bound(solid.begin(), solid.end(), i);
    const bool last = after == solid.end() || (after != solid.begin() && i - *(after - 1) < *after - i);
    held[i] = held[last ? *(after - 1) : *after];
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (held[i]) {
      to[i] = front.points[i].position;
      ++count;
    }
  return count;
}

void hold_sliding(const FrontState& front, std::span<const double> spacing, std::vector<Vec3>& to) {
  if (!front.has_moved) return;
  for (std::size_t i = 0; i < to.size(); ++i)
    if (distance_from_front(front, to[i]) < snap_spacings * spacing[i]) to[i] = front.points[i].position;
}

}  // namespace geo
