// Advises the kernel how to back large arrays (madvise on Linux; nothing elsewhere).
#include "base/uninitialized_array.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstdint>

namespace geo {
namespace {

#ifdef __linux__
// For the huge pages that are within the memory as a whole.
void advise(void* at, std::size_t bytes, int advice) {
  constexpr std::uintptr_t page = std::uintptr_t(2) << 20;  // 2 MiB; arrays below 8 MiB are left alone
  if (bytes < 4 * page) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(at);
  const auto first = (begin + page - 1) / page * page, last = (begin + bytes) / page * page;
  // Advice only: its failure is harmless, so the return value is ignored.
  madvise(reinterpret_cast<void*>(first), last - first, advice);
}
#endif

}  // namespace

void advise_huge_pages([[maybe_unused]] void* at, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  advise(at, bytes, MADV_HUGEPAGE);
#endif
}

void forbid_huge_pages([[maybe_unused]] void* at, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  advise(at, bytes, MADV_NOHUGEPAGE);
#endif
}

}  // namespace geo
