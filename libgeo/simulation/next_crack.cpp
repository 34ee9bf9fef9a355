// A number that a front has had which is gone, and has cut nothing, is given again.
#include "simulation/next_crack.h"

#include <algorithm>

namespace geo {

std::int32_t next_crack(const Complex& surface, const RunState& state) {
  std::int32_t last = surface.crack_count();
  for (const auto& fronts : state.fronts)
    for (const EdgeFront& edge : fronts) last = std::max(last, edge.front.crack);
  for (const GrowingFront& growing : state.fracture.fronts) last = std::max(last, growing.front.crack);
  return last + 1;
}

}  // namespace geo
