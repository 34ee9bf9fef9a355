#include "kerf/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <memory>

namespace geo {
namespace {
std::unique_ptr<tbb::global_control> limit;
int wanted = 0;
thread_local int alone = 0;
}  // namespace

Alone::Alone() { ++alone; }
Alone::~Alone() { --alone; }

void set_threads(int count) {
  wanted = count > 0 ? count : 0;
  limit.reset();
  if (wanted > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(wanted));
}

int threads() { return wanted > 0 ? wanted : tbb::info::default_concurrency(); }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  if (threads() == 1 || alone > 0 || count <= grain) return body(0, count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
}

void at_once(const std::function<void()>& one, const std::function<void()>& other) {
  if (threads() > 1 && alone == 0) return tbb::parallel_invoke(one, other);
  one();
  other();
}

}  // namespace geo
