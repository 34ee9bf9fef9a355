// The function that kerf-scan.so exports.
#pragma once

#include "scan/scan.h"

extern "C" {
/// scan::reconstruct() without exceptions: returns whether it succeeded, and sets `message` where
/// it did not.
__attribute__((visibility("default"))) bool kerf_scan_reconstruct(const geo::PointCloud* cloud,
                                                                  const scan::Options* options, scan::Result* result,
                                                                  std::string* message);
}
