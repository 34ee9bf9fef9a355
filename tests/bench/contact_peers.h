// The parts of the contact benchmark.
#pragma once

#include <vector>

#include "bench.h"
#include "kerf/vec.h"

namespace bench {

/// A folded sheet of two sizes: pairs of boxes and motion without crossing.
void contact_of_sheet(const Options& options);

/// CPU seconds on one thread from boxes to a list of the pairs that meet.
double own_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs);
double cgal_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs);

}  // namespace bench
