// The part of a blade's edge that is about in the material: the front that it leaves, point by point.
#pragma once

#include <cstdint>
#include <vector>

#include "crack/advance.h"

namespace geo {

struct EdgeFront {
  FrontState front;
  std::vector<double> at;  ///< per front point, ascending: where on the edge; n + t is between the blade's points n and n + 1
};

}  // namespace geo
