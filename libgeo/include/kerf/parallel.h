// Threads: one loop and one pair, deterministic for any number of them because each index writes only its own slots.
#pragma once

#include <cstddef>
#include <functional>

namespace geo {

/// Sets how many threads `parallel_for` may use from now on; 0 means all cores. Call it before any work starts.
void set_threads(int count);

/// How many threads `parallel_for` uses.
int threads();

/// While one lives, loops of the thread that made it go on in that thread alone: for work that others do not wait for,
/// beside work that they do.
class Alone {
 public:
  Alone();
  ~Alone();
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;
};

/// Calls body(begin, end) for disjoint ranges that cover [0, count), in any order and from any thread.
/// `grain` is the smallest range worth a task. Exceptions thrown by `body` are passed on to the caller.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Calls both, in any order and from any thread. Exceptions are passed on as by parallel_for().
void at_once(const std::function<void()>& one, const std::function<void()>& other);

}  // namespace geo
