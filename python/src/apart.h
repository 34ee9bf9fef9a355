// Calls of the library that ask too seldom whether they are to stop run in a thread of their own,
// which is left alone when the caller stops.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "kerf/progress.h"
#include "progress.h"

namespace kerf_python {

/// Shared by a call and its caller, who may go before the call ends.
struct Apart {
  std::mutex mutex;
  std::condition_variable changed;
  std::string phase;
  std::size_t done = 0, total = 1;
  bool stopped = false;
  bool ended = false;
  std::exception_ptr error;
};

/// Runs `work` in a thread of its own; waits for its end, and passes its reports on. Throws
/// Interrupted as soon as `progress` asks for it, while the thread ends in its own time: `work`
/// holds what it needs. To be called without the GIL.
void run_in_thread(const geo::Progress& progress, const std::string& phase,
                   std::function<void(const geo::Progress&)> work);

/// As run_in_thread(), for work that returns something.
template <class Work>
auto run_apart(const geo::Progress& progress, const std::string& phase, Work work) {
  auto result = std::make_shared<std::optional<decltype(work(progress))>>();
  run_in_thread(progress, phase,
                [result, work = std::move(work)](const geo::Progress& own) { result->emplace(work(own)); });
  return std::move(**result);
}

/// Runs `work`, which takes a geo::Progress of its own, as run_apart(): `progress` or Ctrl-C ends
/// the call at once. `work` holds what it needs, and nothing of Python. To be called with the GIL.
template <class Work>
auto stoppable(const std::string& phase, Work work, py::object progress = py::none()) {
  ProgressReport report(std::move(progress));
  return report.run([&](const geo::Progress& tell) { return run_apart(tell, phase, std::move(work)); });
}

/// Registers a function that runs before the interpreter ends: it waits a moment for threads that
/// were left alone, as they use what the end of the process destroys. Where some go on, the process
/// ends with its own status before libraries are closed.
void wait_for_threads_at_exit();

}  // namespace kerf_python
