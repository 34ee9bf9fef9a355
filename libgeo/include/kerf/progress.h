// Progress reports of long calls, their cancellation, and a stopwatch.
#pragma once

#include <chrono>
#include <functional>
#include <string_view>

#include "kerf/error.h"

namespace geo {

/// Receives the name of the current phase, the work done and the total work, in units of the phase.
/// Returning false cancels the call, which then throws Interrupted and changes nothing. An empty
/// function is allowed: progress is then not reported.
using Progress = std::function<bool(std::string_view phase, std::size_t done, std::size_t total)>;

/// Calls `progress` if it is not empty; throws Interrupted if it returns false.
inline void report(const Progress& progress, std::string_view phase, std::size_t done, std::size_t total) {
  if (progress && !progress(phase, done, total)) throw Interrupted();
}

/// Wall-clock time of consecutive phases.
class Stopwatch {
 public:
  /// Seconds since the previous call, at first since the construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace geo
