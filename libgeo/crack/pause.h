// Places in long work at which the caller may stop it.
#pragma once

#include <cstddef>
#include <functional>
#include <thread>

namespace geo::crack {

/// Is called now and then, and may throw; empty: nothing stops the work.
using Pause = std::function<void()>;

/// Pauses.
inline void pause_now(const Pause& pause) {
  if (pause) pause();
}

/// Pauses before item `i` of a loop where it is the first of 256: a few milliseconds of work.
inline void pause_before(std::size_t i, const Pause& pause) {
  if (pause && i % 256 == 0) pause();
}

/// Pauses in work on several threads: on the thread that made it alone, so that `pause` needs no
/// lock.
class PauseOfThread {
 public:
  /// For this thread. `pause` must outlive it.
  explicit PauseOfThread(const Pause& pause) : pause_(pause), thread_(std::this_thread::get_id()) {}
  /// Pauses where that is this thread.
  void operator()() const {
    if (pause_ && std::this_thread::get_id() == thread_) pause_();
  }

 private:
  const Pause& pause_;
  const std::thread::id thread_;
};

}  // namespace geo::crack
