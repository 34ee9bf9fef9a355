// The GIL for calls that may outlast the interpreter: those of daemon threads.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

namespace kerf_python {

namespace py = pybind11;

/// Runs without the GIL while it lives. A thread that wants the GIL back after the interpreter has
/// ended is held until the process ends: CPython would unwind it by force, which ends the process.
class GilRelease {
 public:
  GilRelease();
  ~GilRelease();
  GilRelease(const GilRelease&) = delete;
  GilRelease& operator=(const GilRelease&) = delete;

 private:
  PyThreadState* const state_;
};

/// Holds the GIL while it lives, in any thread; as GilRelease after the interpreter has ended.
class GilAcquire {
 public:
  GilAcquire();

 private:
  std::optional<py::gil_scoped_acquire> gil_;
};

/// Whether the interpreter is about to end, so that running calls are to stop.
bool is_ending();

/// Registers a function of this extension that runs before the interpreter ends: it stops calls
/// that daemon threads are in, and waits for them, at most a second.
void stop_calls_at_exit();

}  // namespace kerf_python
