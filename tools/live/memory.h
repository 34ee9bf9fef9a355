// Memory that a long run has freed goes back to the system.
#pragma once

namespace live {

/// Returns freed memory to the system, where the C library can (glibc). It would keep the most that
/// the run has ever used. Takes some milliseconds.
void release_free_memory();

}  // namespace live
