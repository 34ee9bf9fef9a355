// The parallel primitives of kerf/parallel.h, on top of base/parallel_backend.h.
#include "kerf/parallel.h"

#include <exception>

#include "base/parallel_backend.h"

namespace geo {
namespace {
int requested_threads = 0;           // 0: one for each core
thread_local int serial_scopes = 0;  // number of living SerialScopes of this thread
}  // namespace

SerialScope::SerialScope() { ++serial_scopes; }
SerialScope::~SerialScope() { --serial_scopes; }

void set_threads(int count) {
  requested_threads = count > 0 ? count : 0;
  limit_machine_threads(requested_threads);
}

int threads() { return requested_threads > 0 ? requested_threads : machine_threads(); }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  if (threads() == 1 || serial_scopes > 0 || count <= grain) return body(0, count);
  run_loop(threads(), count, grain, body);
}

void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second) {
  // An exception that passed a task would cancel loops within the other one, which would go on with
  // what they had left undone.
  std::exception_ptr failures[2];
  const auto guarded = [&](std::size_t i) {
    try {
      i == 0 ? first() : second();
    } catch (...) {
      failures[i] = std::current_exception();
    }
  };
  if (threads() == 1 || serial_scopes > 0) {
    guarded(0);
    guarded(1);
  } else {
    run_pair(
        threads(), [&] { guarded(0); }, [&] { guarded(1); });
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace geo
