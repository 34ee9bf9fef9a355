// Memory that a long run has freed goes back to the system.
#pragma once

namespace live {

/// Lets each arena of the C library's heap keep about 4 MB of free memory at its end (glibc). It
/// would keep up to 64 MB, and release_free_memory() reaches the end of the main arena only.
void limit_free_memory();

/// Returns freed memory to the system, where the C library can (glibc). It would keep the most that
/// the run has ever used. Takes some milliseconds.
void release_free_memory();

}  // namespace live
