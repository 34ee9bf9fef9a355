// Shared-memory parallelism. Results do not depend on the number of threads, provided that each
// index writes only to its own elements.
#pragma once

#include <cstddef>
#include <functional>

namespace geo {

/// Sets the number of threads that the library uses; 0: one for each core. Must be called while no
/// parallel work runs.
void set_threads(int count);

/// The number of threads that the library uses.
int threads();

/// While an object of this class lives, parallel_for() and parallel_invoke() run serially if called
/// from the thread that created it. Intended for background work, which would otherwise compete for
/// threads with the work in the foreground.
class SerialScope {
 public:
  /// Begins the scope for the calling thread. Scopes may be nested.
  SerialScope();
  ~SerialScope();
  SerialScope(const SerialScope&) = delete;
  SerialScope& operator=(const SerialScope&) = delete;
};

/// Calls body(begin, end) for disjoint ranges that cover [0, count), in any order and from any
/// thread. Ranges of `grain` indices or fewer are not divided. Rethrows an exception of `body`.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Calls both functions, in any order and from any thread. Both run to their ends or exceptions;
/// then the first one's exception is rethrown, else the second one's.
void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second);

}  // namespace geo
