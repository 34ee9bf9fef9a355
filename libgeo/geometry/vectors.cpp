// kerf/vectors.h, by Highway's choice among instruction sets. On x86, better sets have lower bits.
#include "kerf/vectors.h"

#include <hwy/targets.h>

#include <atomic>

namespace geo {
namespace {

#ifdef __EMSCRIPTEN__
constexpr Vectors at_start = Vectors::portable;
#else
constexpr Vectors at_start = Vectors::widest;
#endif
std::atomic<Vectors> in_use = at_start;

}  // namespace

void set_vectors([[maybe_unused]] Vectors kind) {
#ifndef __EMSCRIPTEN__
  in_use = kind;
#endif
#if HWY_ARCH_X86 && !defined(__EMSCRIPTEN__)
  hwy::DisableTargets(kind == Vectors::portable ? HWY_SSE4 - 1 : 0);
#endif
}

Vectors vectors() { return in_use; }

}  // namespace geo
