// The caller looks for Ctrl-C fifty times a second.
#include "apart.h"

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "gil.h"
#include "kerf/error.h"

namespace kerf_python {
namespace {

using namespace std::chrono_literals;

std::atomic<int> threads = 0;

void wait_for_threads() {
  const auto limit = std::chrono::steady_clock::now() + 200ms;
  const GilRelease release;
  while (threads > 0 && std::chrono::steady_clock::now() < limit) std::this_thread::sleep_for(5ms);
}

// A fit of a scan reports nothing, so it cannot be stopped, and lasts a minute. Libraries that a
// thread still uses must not be closed under it: the process ends here instead.
void end_with_threads(int status, void*) {
  if (threads == 0) return;
  std::fflush(nullptr);
  std::_Exit(status);
}

// Libraries that are loaded later close earlier, so this comes after those of the work.
void end_with_threads_at_exit() {
  static const int once = on_exit(&end_with_threads, nullptr);
  static_cast<void>(once);
}

// Runs the work, in its thread. Nothing of Python is called.
void run(const std::shared_ptr<Apart>& shared, std::function<void(const geo::Progress&)> work) {
  std::exception_ptr error;
  try {
    work([&](std::string_view phase, std::size_t done, std::size_t total) {
      const std::lock_guard lock(shared->mutex);
      shared->phase = phase;
      shared->done = done;
      shared->total = total;
      return !shared->stopped;
    });
  } catch (...) {
    error = std::current_exception();
  }
  work = nullptr;
  {
    const std::lock_guard lock(shared->mutex);
    shared->error = error;
    shared->ended = true;
    shared->changed.notify_all();
  }
  --threads;
}

}  // namespace

void run_in_thread(const geo::Progress& progress, const std::string& phase,
                   std::function<void(const geo::Progress&)> work) {
  const auto shared = std::make_shared<Apart>();
  shared->phase = phase;
  geo::report(progress, phase, 0, 1);
  end_with_threads_at_exit();
  ++threads;
  std::thread(run, shared, std::move(work)).detach();
  std::unique_lock lock(shared->mutex);
  while (!shared->changed.wait_for(lock, 20ms, [&] { return shared->ended; })) {
    const std::string now = shared->phase;
    const std::size_t done = shared->done;
    const std::size_t total = shared->total;
    lock.unlock();
    const bool wanted = progress(now, done, total);
    lock.lock();
    if (wanted) continue;
    shared->stopped = true;
    throw geo::Interrupted();
  }
  if (shared->error) std::rethrow_exception(shared->error);
  geo::report(progress, shared->phase, shared->done, shared->total);
}

void wait_for_threads_at_exit() { py::module_::import("atexit").attr("register")(py::cpp_function(&wait_for_threads)); }

}  // namespace kerf_python
