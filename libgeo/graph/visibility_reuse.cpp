// Old and new row ascend and are merged in vectors. Entry e is open (to be tested again) unless it
// is an edge, or it was visible and no new face hides it: open = ¬(edge ∨ (visible ∧ ¬hidden)).
// Compiled for each instruction set (base/simd_targets.h).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "graph/visibility_reuse.cpp"
#include "base/simd_targets.h"

#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>
#include <cstring>

#include "graph/graph_storage.h"
#include "graph/visibility_reuse.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::size_t EntriesToRetest(std::span<const std::uint32_t> to, std::span<const std::uint16_t> bits,
                            const AdjacencyRow& old, std::span<const std::uint32_t> hidden, std::uint32_t* retest) {
  const hn::CappedTag<std::uint32_t, 16> d;
  const hn::Rebind<std::uint16_t, decltype(d)> dh;
  const std::size_t lanes = hn::Lanes(d), count = to.size(), old_count = old.to.size();
  std::size_t found = 0;
  const auto retest_entry = [&](std::size_t e) {
    if (AdjacencyRow::is_edge(bits[e])) return;
    const auto at = std::lower_bound(old.to.begin(), old.to.end(), to[e]);
    const bool was_visible = at != old.to.end() && *at == to[e] &&
                             !(old.bits[static_cast<std::size_t>(at - old.to.begin())] & AdjacencyRow::path_bit);
    const bool is_hidden = was_visible && std::binary_search(hidden.begin(), hidden.end(), to[e]);
    if (!was_visible || is_hidden) retest[found++] = static_cast<std::uint32_t>(e) | (is_hidden ? hidden_bit : 0);
  };
  if (count < lanes || old_count < lanes) {
    for (std::size_t e = 0; e < count; ++e) retest_entry(e);
    return found;
  }
  const auto edge = hn::Set(d, std::uint32_t(AdjacencyRow::edge_bit)),
             path = hn::Set(d, std::uint32_t(AdjacencyRow::path_bit));
  const auto zero = hn::Zero(d);
  const auto nothing = hn::Ne(zero, zero);
  std::size_t gone = 0;  // entries of the old row that the new one has left out so far
  std::size_t next_hidden = 0;
  for (std::size_t e = 0; e < count; e += lanes) {
    const auto at = std::min(e, count - lanes);
    const auto now = hn::LoadU(d, to.data() + at);
    // The old row has nearly all ids of the new one, which `gone` entries have left so far. So the
    // search begins at index at + gone of the old row and ends after a few vectors.
    auto same = nothing, visible = nothing;
    for (std::size_t k = at + gone; k <= old_count - lanes; ++k) {
      const auto equal = hn::Eq(now, hn::LoadU(d, old.to.data() + k));
      if (hn::AllFalse(d, equal)) {
        if (old.to[k] > to[at + lanes - 1]) break;
        continue;
      }
      gone = k - at;
      same = hn::Or(same, equal);
      visible = hn::Or(
          visible, hn::And(equal, hn::Eq(hn::And(hn::PromoteTo(d, hn::LoadU(dh, old.bits.data() + k)), path), zero)));
      if (hn::AllTrue(d, same)) break;
    }
    auto is_hidden = nothing;
    while (next_hidden > 0 && at < e && hidden[next_hidden - 1] >= to[at]) --next_hidden;
    while (next_hidden < hidden.size() && hidden[next_hidden] <= to[at + lanes - 1])
      is_hidden = hn::Or(is_hidden, hn::Eq(now, hn::Set(d, hidden[next_hidden++])));
    const auto is_edge = hn::Ne(hn::And(hn::PromoteTo(d, hn::LoadU(dh, bits.data() + at)), edge), zero);
    auto open = hn::Not(hn::Or(is_edge, hn::AndNot(is_hidden, visible)));
    if (at < e) open = hn::AndNot(hn::FirstN(d, e - at), open);
    if (hn::AllFalse(d, open)) continue;
    std::uint8_t open_bits[8] = {};
    hn::StoreMaskBits(d, open, open_bits);
    std::uint64_t rest;
    for (std::memcpy(&rest, open_bits, 8); rest != 0; rest &= rest - 1)
      retest_entry(at + hwy::Num0BitsBelowLS1Bit_Nonzero64(rest));
  }
  return found;
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(EntriesToRetest);

std::size_t entries_to_retest(std::span<const std::uint32_t> to, std::span<const std::uint16_t> bits,
                              const AdjacencyRow& old, std::span<const std::uint32_t> hidden, std::uint32_t* retest) {
  return HWY_DYNAMIC_DISPATCH(EntriesToRetest)(to, bits, old, hidden, retest);
}

}  // namespace geo
#endif
