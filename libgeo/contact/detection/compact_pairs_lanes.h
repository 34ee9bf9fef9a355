// Stream compaction of lists of pairs, for sources that Highway compiles for each instruction set.
// Include it after Highway. It is read once for each instruction set.
#if defined(KERF_COMPACT_PAIRS_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_COMPACT_PAIRS_LANES
#undef KERF_COMPACT_PAIRS_LANES
#else
#define KERF_COMPACT_PAIRS_LANES
#endif

#include <cstddef>

/// Begins code for the current instruction set.
HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

/// Moves the pairs for which keep(pair) is true to the front, in their order, and returns their
/// number. Without branches, since the outcome of `keep` is hard to predict.
template <class Pair, class Keep>
HWY_INLINE std::size_t compact_pairs(Pair* pairs, std::size_t count, const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair pair = pairs[i];
    pairs[kept] = pair;
    kept += keep(pair);
  }
  return kept;
}

}  // namespace geo::HWY_NAMESPACE
/// Ends code for the current instruction set.
HWY_AFTER_NAMESPACE();

#endif
