// What is different between two bodies, the second of which is as a rule the first after a crack.
#pragma once

#include <kerf/body.h>
#include "info/report.h"

namespace info {

/// Counts of what differs and, with each, up to eight of the ids; returns whether all is the same.
bool report_difference(const geo::Body& a, const geo::Body& b, Report& report);

}  // namespace info
