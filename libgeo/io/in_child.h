// Runs code that may crash, hang or eat memory, as readers of other people's formats do, in a
// process of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <stdexcept>
#include <string>

namespace geo {

/// The most that a child process may use.
struct ChildLimits {
  std::size_t memory = 1ull << 30;  ///< bytes beyond those that this process has mapped
  unsigned seconds = 30;            ///< of processor time; thrice as long by the clock
};

/// A child process ended without a result. what() is the end of a sentence: "crashes (signal 11)".
struct ChildFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs `work` in a child process, a copy of this one, and returns the bytes that it wrote. The
/// child has no other threads, so `work` must start none and wait for none. Its messages on
/// standard error are lost. A std::exception that leaves `work` is thrown here as InputError with
/// the same text. Throws ChildFailure where the child crashes or exceeds a limit.
std::string in_child(const std::function<void(std::ostream&)>& work, const ChildLimits& limits);

}  // namespace geo
