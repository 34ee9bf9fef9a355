// Places in long work at which the caller may stop it.
#pragma once

#include <cstddef>
#include <functional>

namespace geo::crack {

/// Is called now and then, and may throw; empty: nothing stops the work.
using Pause = std::function<void()>;

/// Pauses before item `i` of a loop where it is the first of 256: a few milliseconds of work.
inline void pause_before(std::size_t i, const Pause& pause) {
  if (pause && i % 256 == 0) pause();
}

}  // namespace geo::crack
