// The threads below kerf/parallel.h: oneTBB's (parallel_tbb.cpp), or those of the standard library
// (parallel_std.cpp) in a build without it and under the thread sanitizer.
#pragma once

#include <cstddef>
#include <functional>

namespace geo {

/// Number of threads that the machine runs at once.
int machine_threads();
/// Limits the threads of later calls, the calling one included; 0: one for each core.
void limit_machine_threads(int count);

/// Calls body(begin, end) for disjoint ranges of about `grain` indices that cover [0, count), in
/// `threads` threads at most. Rethrows the first exception of `body`.
void run_loop(int threads, std::size_t count, std::size_t grain,
              const std::function<void(std::size_t, std::size_t)>& body);
/// Runs both, at the same time where there is a thread. Neither throws.
void run_pair(int threads, const std::function<void()>& first, const std::function<void()>& second);

}  // namespace geo
