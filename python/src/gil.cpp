// Before Python 3.14, PyEval_RestoreThread() calls pthread_exit() after the end of the interpreter.
// glibc does that by an exception, which destructors must not let pass.
#include "gil.h"

#include <cxxabi.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace kerf_python {
namespace {

std::atomic<bool> ending = false;
std::atomic<int> running = 0;  // calls without the GIL

[[noreturn]] void wait_for_exit() {
  for (;;) ::pause();
}

void stop_calls() {
  ending = true;
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  py::gil_scoped_release release;
  while (running > 0 && std::chrono::steady_clock::now() < limit)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

GilRelease::GilRelease() : state_(PyEval_SaveThread()) { ++running; }

GilRelease::~GilRelease() {
  --running;
  try {
    PyEval_RestoreThread(state_);
  } catch (abi::__forced_unwind&) {
    wait_for_exit();
  }
}

GilAcquire::GilAcquire() {
  try {
    gil_.emplace();
  } catch (abi::__forced_unwind&) {
    wait_for_exit();
  }
}

bool is_ending() { return ending; }

void stop_calls_at_exit() { py::module_::import("atexit").attr("register")(py::cpp_function(&stop_calls)); }

}  // namespace kerf_python
