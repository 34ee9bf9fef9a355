// The parallel primitives of kerf/parallel.h, on top of oneTBB; under the thread sanitizer, on top
// of threads of the standard library (base/parallel_threads.h).
#include "kerf/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <exception>
#include <memory>

#include "base/parallel_threads.h"

namespace geo {
namespace {
std::unique_ptr<tbb::global_control> limit;
int requested_threads = 0;           // 0: one for each core
thread_local int serial_scopes = 0;  // number of living SerialScopes of this thread
}  // namespace

SerialScope::SerialScope() { ++serial_scopes; }
SerialScope::~SerialScope() { --serial_scopes; }

void set_threads(int count) {
  requested_threads = count > 0 ? count : 0;
  limit.reset();
  if (requested_threads > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(requested_threads));
}

int threads() { return requested_threads > 0 ? requested_threads : tbb::info::default_concurrency(); }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  if (threads() == 1 || serial_scopes > 0 || count <= grain) return body(0, count);
#ifdef KERF_SANITIZE_THREADS
  parallel_for_by_threads(threads(), count, grain, body);
#else
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
#endif
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
#ifdef KERF_SANITIZE_THREADS
    parallel_for_by_threads(threads(), 2, 1, [&](std::size_t i, std::size_t) { guarded(i); });
#else
    tbb::parallel_invoke([&] { guarded(0); }, [&] { guarded(1); });
#endif
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace geo
