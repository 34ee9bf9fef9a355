// kerf/vectors.h, by Highway's choice among instruction sets. On x86, better sets have lower bits.
#include "kerf/vectors.h"

#include <hwy/targets.h>

namespace geo {

void set_vectors([[maybe_unused]] Vectors kind) {
#if HWY_ARCH_X86 && !defined(__EMSCRIPTEN__)
  hwy::DisableTargets(kind == Vectors::portable ? HWY_SSE4 - 1 : 0);
#endif
}

}  // namespace geo
