// Leaves pairs out of a list, for sources that Highway compiles once for each kind of vector: these include it, after
// Highway.
#if defined(KERF_KEEP_LANES) == defined(HWY_TARGET_TOGGLE)  // once for each kind, too
#ifdef KERF_KEEP_LANES
#undef KERF_KEEP_LANES
#else
#define KERF_KEEP_LANES
#endif

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

/// Those kept come first, in their order; returns how many. Without branches, as which it will be cannot be foretold.
template <class Pair, class Keep>
HWY_INLINE std::size_t keep_pairs(Pair* pairs, std::size_t count, const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair pair = pairs[i];
    pairs[kept] = pair;
    kept += keep(pair);
  }
  return kept;
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
