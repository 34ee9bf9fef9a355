// The parts of the contact benchmark.
#pragma once

#include <vector>

#include "bench.h"
#include "kerf/vec.h"

namespace bench {

/// Benchmarks a folded sheet of two sizes: pairs of boxes, and motion without crossing.
void contact_of_sheet(const Options& options);

/// CPU seconds on one thread from boxes to the pairs that meet, whose number is written to `pairs`.
double own_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs);
/// As own_pairs_seconds(), by CGAL.
double cgal_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs);

}  // namespace bench
