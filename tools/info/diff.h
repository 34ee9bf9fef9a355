// Differences between two bodies, in general one body before and after a crack.
#pragma once

#include <kerf/body.h>
#include "info/report.h"

namespace info {

/// Reports the number of differences of each kind, with up to eight ids. Returns whether the bodies
/// are equal.
bool report_difference(const geo::Body& a, const geo::Body& b, Report& report);

}  // namespace info
