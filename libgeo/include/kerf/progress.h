// How a long call says how far it is, and how it is asked to stop.
#pragma once

#include <chrono>
#include <functional>
#include <string_view>

#include "kerf/error.h"

namespace geo {

/// Called with the name of the phase, what is done and what there is to do. Return false to stop the work:
/// the call then throws Interrupted and leaves everything as it was. An empty function means "nobody listens".
using Progress = std::function<bool(std::string_view phase, std::size_t done, std::size_t total)>;

/// Reports to `progress` if somebody listens; throws Interrupted when asked to stop.
inline void report(const Progress& progress, std::string_view phase, std::size_t done, std::size_t total) {
  if (progress && !progress(phase, done, total)) throw Interrupted();
}

// ---- Seconds by phase.

class Stopwatch {
 public:
  /// Seconds since the last call or the construction.
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
