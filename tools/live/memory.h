// Memory that a long run has freed goes back to the system.
#pragma once

namespace live {

/// Lets all threads share one heap, where the C library has several (glibc). The others would keep
/// their free ends, whatever is released. To be called before threads allocate.
void use_one_heap();

/// Returns freed memory to the system, where the C library can (glibc). It would keep the most that
/// the run has ever used. Takes some milliseconds.
void release_free_memory();

}  // namespace live
