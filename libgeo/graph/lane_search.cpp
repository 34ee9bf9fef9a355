// Highway compiles the part between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each kind of vector.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "graph/lane_search.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <bit>
#include <cstring>

#include "graph/lane_search.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void Lengths(const double* squared, const double* radius, std::size_t count, std::uint32_t* lengths) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  const auto least = hn::Set(d, 1.0), most = hn::Set(d, double(longest_length)), unit = hn::Set(d, double(unit_radius));
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const auto length = hn::Ceil(hn::Mul(hn::Div(hn::Sqrt(hn::LoadU(d, squared + k)), hn::LoadU(d, radius + k)), unit));
    hn::StoreU(hn::DemoteTo(di, hn::Min(hn::Max(length, least), most)), di, reinterpret_cast<std::int32_t*>(lengths) + k);
  }
}

// Of the entries of which `part` of the bits is not `refused`. Whole vectors only: the last of them begins so early that it ends
// with the row, without the entries that were taken.
std::size_t LeadOn(const RowView& row, std::uint32_t part, std::uint32_t refused, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths) {
  const std::uint32_t* const to = row.to.data();
  const std::uint16_t* const bits = row.bits.data();
  const std::size_t count = row.to.size();
  const hn::CappedTag<std::uint32_t, 16> d;
  const hn::Rebind<std::uint16_t, decltype(d)> dh;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t found = 0;
  const auto take = [&](std::size_t k) {
    const auto next = reach + VisibilityGraph::bound(bits[k]);
    targets[found] = to[k], lengths[found] = next;
    found += ((bits[k] & part) != refused) & (next < unit_radius);
  };
  if (count < lanes) {
    for (std::size_t k = 0; k < count; ++k) take(k);
    return found;
  }
  const auto asked = hn::Set(d, part), not_these = hn::Set(d, refused), bound = hn::Set(d, std::uint32_t(VisibilityGraph::bound_bits));
  const auto from = hn::Set(d, reach), radius = hn::Set(d, unit_radius);
  for (std::size_t k = 0; k < count; k += lanes) {
    const auto at = std::min(k, count - lanes);
    const auto entry = hn::PromoteTo(d, hn::LoadU(dh, bits + at));
    const auto next = hn::Add(from, hn::ShiftLeft<10>(hn::And(entry, bound)));
    auto leads = hn::And(hn::Ne(hn::And(entry, asked), not_these), hn::Lt(next, radius));
    if (at < k) leads = hn::AndNot(hn::FirstN(d, k - at), leads);
    hn::StoreU(hn::Compress(next, leads), d, lengths + found);  // CompressStore() is slow on some processors
    hn::StoreU(hn::Compress(hn::LoadU(d, to + at), leads), d, targets + found);
    found += hn::CountTrue(d, leads);
  }
  return found;
}

void Search(const LocalGraph& graph, LaneSearch::Work& w) {
  using Tag = hn::CappedTag<std::int32_t, LaneSearch::lanes>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag()), parts = LaneSearch::lanes / step;
  const auto zero = hn::Zero(d), far = hn::Set(d, std::int32_t(LaneSearch::far));
  LaneSearch::Lanes* const distances = w.distances.data();
  const auto lanes_of = [=](std::uint32_t node) { return reinterpret_cast<std::int32_t*>(distances[node].distance); };
  const std::uint32_t* const limits = graph.limits().data();
  std::uint8_t* const touched = w.touched.data();
  const std::uint32_t mask = static_cast<std::uint32_t>(w.queue.size() - 1);
  std::uint8_t* const queued = w.queued.data();
  std::uint32_t* const queue = w.queue.data();
  std::uint32_t tail = w.tail;
  for (std::uint32_t head = 0; head != tail; ++head) {
    const auto u = queue[head & mask];
    queued[u] = 0;
    hn::Vec<Tag> from[parts];
    auto least = far;
    for (std::size_t p = 0; p < parts; ++p) {
      from[p] = hn::Load(d, lanes_of(u) + p * step);
      // A source's own edges have been followed.
      least = hn::Min(least, hn::IfThenElse(hn::Eq(from[p], zero), far, from[p]));
    }
    const auto nearest = static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(d, least)));
    const std::uint32_t end = LocalGraph::end_of_classes(nearest);
    for (const auto edge : graph.edges(u)) {
      if (edge.length >= end) break;
      const auto length = hn::Set(d, std::int32_t(edge.length)), limit = hn::Set(d, std::int32_t(limits[edge.to]));
      auto* const to = lanes_of(edge.to);
      bool leads_on = false;
      for (std::size_t p = 0; p < parts; ++p) {
        const auto next = hn::Add(from[p], length), known = hn::Load(d, to + p * step);
        leads_on |= !hn::AllFalse(d, hn::Lt(next, hn::Min(known, limit)));
        hn::Store(hn::Min(next, known), d, to + p * step);
      }
      const std::uint8_t enters = leads_on & (queued[edge.to] ^ 1);
      touched[edge.to] = 1;
      queued[edge.to] |= enters;
      queue[tail & mask] = edge.to;
      tail += enters;
    }
  }
}

// Appends each touched node to the rows of the lanes that reach it, and forgets its distances.
void Collect(LaneSearch::Work& w, LaneSearch::Found* const* rows, std::uint32_t* counts) {
  using Tag = hn::CappedTag<std::int32_t, LaneSearch::lanes>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const auto zero = hn::Zero(d), far = hn::Set(d, std::int32_t(LaneSearch::far)), radius = hn::Set(d, std::int32_t(unit_radius));
  LaneSearch::Lanes* const distances = w.distances.data();
  const std::size_t size = w.touched.size();
  std::uint8_t* const touched = w.touched.data();
  LaneSearch::Found* ends[LaneSearch::lanes];
  std::copy(rows, rows + LaneSearch::lanes, ends);
  for (std::size_t first = 0; first < size; first += 8) {
    std::uint64_t rest;
    std::memcpy(&rest, touched + first, 8);
    for (std::memset(touched + first, 0, 8); rest != 0; rest &= rest - 1) {
      const auto node = static_cast<std::uint32_t>(first + hwy::Num0BitsBelowLS1Bit_Nonzero64(rest) / 8);
      auto* const distance = reinterpret_cast<std::int32_t*>(distances[node].distance);
      std::uint32_t reached = 0;
      alignas(64) std::int32_t found[LaneSearch::lanes];
      for (std::size_t p = 0; p < LaneSearch::lanes; p += step) {
        const auto known = hn::Load(d, distance + p);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::And(hn::Lt(known, radius), hn::Gt(known, zero)), bits);
        reached |= std::uint32_t(bits[0] | bits[1] << 8) << p;
        hn::Store(known, d, found + p);
        hn::Store(far, d, distance + p);
      }
      for (; reached != 0; reached &= reached - 1) {
        const auto lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(reached);
        *ends[lane]++ = {node, std::uint32_t(found[lane])};
      }
    }
  }
  for (std::size_t lane = 0; lane < LaneSearch::lanes; ++lane) counts[lane] = static_cast<std::uint32_t>(ends[lane] - rows[lane]);
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Lengths);
HWY_EXPORT(LeadOn);
HWY_EXPORT(Search);
HWY_EXPORT(Collect);

void warped_lengths(const double* squared, const double* radius, std::size_t count, std::uint32_t* lengths) {
  HWY_DYNAMIC_DISPATCH(Lengths)(squared, radius, count, lengths);
}

std::size_t edges_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths) {
  return HWY_DYNAMIC_DISPATCH(LeadOn)(row, VisibilityGraph::edge_bit, 0, reach, targets, lengths);
}

std::size_t neighbors_that_lead_on(const RowView& row, std::uint32_t reach, std::uint32_t* targets, std::uint32_t* lengths) {
  constexpr std::uint32_t bare = VisibilityGraph::edge_bit | VisibilityGraph::path_bit;
  return HWY_DYNAMIC_DISPATCH(LeadOn)(row, bare, bare, reach, targets, lengths);
}

void LaneSearch::run(const LocalGraph& graph, std::span<const std::uint32_t> sources) {
  const std::size_t n = graph.size();
  if (work_.distances.size() < n) {
    Lanes nothing;
    std::fill(std::begin(nothing.distance), std::end(nothing.distance), far);
    work_.distances.resize(n, nothing);
    work_.queued.resize(n, 0);
    work_.queue.resize(std::bit_ceil(n + 1));
    for (auto& row : rows_) row.resize(n);
  }
  work_.touched.resize((n + 7) / 8 * 8, 0);
  Lanes* const distances = work_.distances.data();
  std::uint8_t* const touched = work_.touched.data();
  std::uint8_t* const queued = work_.queued.data();
  std::uint32_t* const queue = work_.queue.data();
  const std::uint32_t* const limits = graph.limits().data();
  std::uint32_t tail = 0;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    distances[sources[k]].distance[k] = 0;
    touched[sources[k]] = 1;
    for (const auto edge : graph.edges(sources[k])) {
      distances[edge.to].distance[k] = edge.length;
      touched[edge.to] = 1;
      const std::uint8_t enters = edge.length < limits[edge.to] && !queued[edge.to];
      queued[edge.to] |= enters;
      queue[tail] = edge.to;
      tail += enters;
    }
  }
  work_.tail = tail;
  HWY_DYNAMIC_DISPATCH(Search)(graph, work_);
  Found* rows[lanes];
  for (std::size_t k = 0; k < lanes; ++k) rows[k] = rows_[k].data();
  HWY_DYNAMIC_DISPATCH(Collect)(work_, rows, counts_);
}

std::vector<std::string> vector_targets() {
  std::vector<std::string> names;
  hwy::SetSupportedTargetsForTest(0);
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) names.push_back(hwy::TargetName(rest & -rest));
  return names;
}

void use_vector_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t wanted = 0;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    if (name == hwy::TargetName(rest & -rest)) wanted = rest & -rest;
  hwy::SetSupportedTargetsForTest(wanted);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace geo
#endif
