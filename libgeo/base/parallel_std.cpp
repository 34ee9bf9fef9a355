// base/parallel_backend.h by threads of the standard library.
#include <algorithm>
#include <thread>

#include "base/parallel_backend.h"
#include "base/parallel_threads.h"

namespace geo {

int machine_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void limit_machine_threads(int) {}  // each call has its limit

void run_loop(int threads, std::size_t count, std::size_t grain,
              const std::function<void(std::size_t, std::size_t)>& body) {
  parallel_for_by_threads(threads, count, grain, body);
}

void run_pair(int threads, const std::function<void()>& first, const std::function<void()>& second) {
  parallel_for_by_threads(threads, 2, 1, [&](std::size_t i, std::size_t) { i == 0 ? first() : second(); });
}

}  // namespace geo
