// A number that a front has had which is gone, and has cut nothing, is given again.
#include "simulation/next_crack.h"

namespace geo {

std::int32_t next_crack(const Complex& surface, const RunState& state) {
  CrackNumbers numbers(surface);
  for (const auto& fronts : state.fronts)
    for (const EdgeFront& edge : fronts) numbers.note(edge.front.crack);
  for (const GrowingFront& growing : state.fracture.fronts) numbers.note(growing.front.crack);
  return numbers.next();
}

}  // namespace geo
