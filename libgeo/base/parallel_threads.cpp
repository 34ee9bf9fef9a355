// Loops by threads of base/parallel_threads.h: each thread takes the next range until none is left.
#include "base/parallel_threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace geo {
namespace {

std::atomic<int> running{0};  // new threads that are alive, of all calls

// Takes one of the new threads that are still allowed; false: none is.
bool take_thread(int allowed) {
  int now = running.load();
  while (now < allowed)
    if (running.compare_exchange_weak(now, now + 1)) return true;
  return false;
}

}  // namespace

void parallel_for_by_threads(int threads, std::size_t count, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::mutex guard;
  std::exception_ptr failure;  // under guard
  const std::size_t length = std::max<std::size_t>(grain, 1);
  const auto work = [&] {
    for (std::size_t begin; (begin = next.fetch_add(length)) < count;) try {
        body(begin, std::min(begin + length, count));
      } catch (...) {
        const std::lock_guard lock(guard);
        if (!failure) failure = std::current_exception();
        next = count;
      }
  };
  std::vector<std::thread> others;
  const std::size_t wanted = std::min<std::size_t>((count + length - 1) / length, std::size_t(std::max(threads, 1)));
  others.reserve(wanted);
  while (others.size() + 1 < wanted && take_thread(threads - 1)) try {
      others.emplace_back(work);
    } catch (const std::system_error&) {  // the system has no more threads: those that there are do the work
      --running;
      break;
    }
  work();
  for (std::thread& other : others) other.join();
  running -= static_cast<int>(others.size());
  if (failure) std::rethrow_exception(failure);
}

}  // namespace geo
