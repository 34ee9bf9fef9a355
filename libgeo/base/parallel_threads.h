// Loops by threads of the standard library, in a build without oneTBB, and under the thread
// sanitizer. It sees how these begin and end, and oneTBB's it does not.
#pragma once

#include <cstddef>
#include <functional>

namespace geo {

/// Calls body(begin, end) for disjoint ranges of about `grain` indices that cover [0, count), in
/// the calling thread and in up to threads - 1 new ones. A nested call whose new threads would
/// exceed that number runs in the calling thread alone. Rethrows the first exception of `body`.
void parallel_for_by_threads(int threads, std::size_t count, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace geo
