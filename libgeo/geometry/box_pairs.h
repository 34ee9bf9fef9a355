// Pairs of boxes that meet, for few boxes and for many.
#pragma once

#include <functional>
#include <vector>

#include "geometry/aabb_tree.h"

namespace geo {

/// All pairs (i < j) of boxes that meet, each once, that `filter` keeps. It is called for batches
/// of pairs, from any thread, and removes unwanted ones. Pairs are in no particular order, which
/// does not depend on the number of threads.
AabbTree::Pairs meeting_pairs(const std::vector<Box3>& boxes, const std::function<void(AabbTree::Pairs&)>& filter);

}  // namespace geo
