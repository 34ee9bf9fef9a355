// Between frames of a body with many cuts, about half of the heap is free.
#include "live/memory.h"

#include <cstdlib>  // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace live {

void limit_free_memory() {
#ifdef __GLIBC__
  // The first of the two keeps large arrays in the heap: given back at each end of use, their pages
  // would be mapped anew in each frame.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
#endif
}

void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace live
