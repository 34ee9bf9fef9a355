// A label-correcting search: a FIFO queue of nodes of which a distance fell (Bellman–Ford–Moore),
// with sixteen distances a node. Compiled for each instruction set (base/simd_targets.h).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "graph/batched_search.cpp"
#include "base/simd_targets.h"

#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <bit>
#include <cstring>
#include <utility>

#include "graph/batched_search.h"
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
    hn::StoreU(hn::DemoteTo(di, hn::Min(hn::Max(length, least), most)), di,
               reinterpret_cast<std::int32_t*>(lengths) + k);
  }
}

// Selects entry k if (bits[k] & mask) ≠ refused and distance + bound(bits[k]) < unit_radius. Works
// in whole vectors: the last one ends with the row, and skips the entries already handled.
std::size_t WithinSupport(const AdjacencyRow& row, std::uint32_t mask, std::uint32_t refused, std::uint32_t distance,
                          std::uint32_t* targets, std::uint32_t* distances) {
  const std::uint32_t* const to = row.to.data();
  const std::uint16_t* const bits = row.bits.data();
  const std::size_t count = row.to.size();
  const hn::CappedTag<std::uint32_t, 16> d;
  const hn::Rebind<std::uint16_t, decltype(d)> dh;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t found = 0;
  if (count < lanes) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto next = distance + AdjacencyRow::bound(bits[k]);
      targets[found] = to[k];
      distances[found] = next;
      found += ((bits[k] & mask) != refused) & (next < unit_radius);
    }
    return found;
  }
  const auto kind = hn::Set(d, mask), refused_kind = hn::Set(d, refused),
             bound = hn::Set(d, std::uint32_t(AdjacencyRow::bound_bits));
  const auto from = hn::Set(d, distance), radius = hn::Set(d, unit_radius);
  for (std::size_t k = 0; k < count; k += lanes) {
    const auto at = std::min(k, count - lanes);
    const auto entry = hn::PromoteTo(d, hn::LoadU(dh, bits + at));
    const auto next = hn::Add(from, hn::ShiftLeft<10>(hn::And(entry, bound)));
    auto within = hn::And(hn::Ne(hn::And(entry, kind), refused_kind), hn::Lt(next, radius));
    if (at < k) within = hn::AndNot(hn::FirstN(d, k - at), within);
    hn::StoreU(hn::Compress(next, within), d, distances + found);  // CompressStore() is slow on some processors
    hn::StoreU(hn::Compress(hn::LoadU(d, to + at), within), d, targets + found);
    found += hn::CountTrue(d, within);
  }
  return found;
}

// Relaxes the edges of each node u in the queue, for all sources s at once:
// d_s(v) ← min(d_s(v), d_s(u) + length(uv)). A node v enters the queue if a distance fell below
// limits[v], from which on no edge of v leads to a neighbour.
void Search(const LocalGraph& graph, BatchedSearch::Scratch& s) {
  using Tag = hn::CappedTag<std::int32_t, BatchedSearch::lanes>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag()), vectors = BatchedSearch::lanes / step;
  const auto zero = hn::Zero(d), far = hn::Set(d, std::int32_t(BatchedSearch::far));
  BatchedSearch::Lanes* const distances = s.distances.data();
  const auto lanes_of = [=](std::uint32_t node) { return reinterpret_cast<std::int32_t*>(distances[node].distance); };
  const std::uint32_t* const limits = graph.limits().data();
  std::uint8_t* const touched = s.touched.data();
  const std::uint32_t mask = static_cast<std::uint32_t>(s.queue.size() - 1);
  std::uint8_t* const queued = s.queued.data();
  std::uint32_t* const queue = s.queue.data();
  std::uint32_t tail = s.tail;
  for (std::uint32_t head = 0; head != tail; ++head) {
    const auto u = queue[head & mask];
    queued[u] = 0;
    hn::Vec<Tag> from[vectors];
    auto least = far;
    for (std::size_t v = 0; v < vectors; ++v) {
      from[v] = hn::Load(d, lanes_of(u) + v * step);
      // A source's own edges are relaxed before the loop.
      least = hn::Min(least, hn::IfThenElse(hn::Eq(from[v], zero), far, from[v]));
    }
    const auto nearest = static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(d, least)));
    const std::uint32_t end = LocalGraph::end_of_classes(nearest);
    for (const auto edge : graph.edges(u)) {
      if (edge.length >= end) break;
      const auto length = hn::Set(d, std::int32_t(edge.length)), limit = hn::Set(d, std::int32_t(limits[edge.to]));
      auto* const to = lanes_of(edge.to);
      bool falls = false;
      for (std::size_t v = 0; v < vectors; ++v) {
        const auto next = hn::Add(from[v], length), known = hn::Load(d, to + v * step);
        falls |= !hn::AllFalse(d, hn::Lt(next, hn::Min(known, limit)));
        hn::Store(hn::Min(next, known), d, to + v * step);
      }
      const std::uint8_t enters = falls & (queued[edge.to] ^ 1);
      touched[edge.to] = 1;
      queued[edge.to] |= enters;
      queue[tail & mask] = edge.to;
      tail += enters;
    }
  }
}

#if HWY_TARGET <= HWY_AVX3
// Transposes a matrix of sixteen vectors of sixteen.
template <class D, class V>
void Transpose(D d, V* v) {
  const hn::Repartition<std::uint64_t, D> dw;
  V pairs[16];
  for (int k = 0; k < 16; k += 2) {
    pairs[k] = hn::InterleaveLower(d, v[k], v[k + 1]);
    pairs[k + 1] = hn::InterleaveUpper(d, v[k], v[k + 1]);
  }
  const auto low = [&](V a, V b) {
    return hn::BitCast(d, hn::InterleaveLower(dw, hn::BitCast(dw, a), hn::BitCast(dw, b)));
  };
  const auto high = [&](V a, V b) {
    return hn::BitCast(d, hn::InterleaveUpper(dw, hn::BitCast(dw, a), hn::BitCast(dw, b)));
  };
  for (int k = 0; k < 16; k += 4) {
    v[k] = low(pairs[k], pairs[k + 2]);
    v[k + 1] = high(pairs[k], pairs[k + 2]);
    v[k + 2] = low(pairs[k + 1], pairs[k + 3]);
    v[k + 3] = high(pairs[k + 1], pairs[k + 3]);
  }
  // Now the k-th block of v[4 r + c] is column 4 k + c of rows 4 r to 4 r + 3.
  for (int c = 0; c < 4; ++c) {
    const V front[2] = {hn::ConcatLowerLower(d, v[8 + c], v[c]), hn::ConcatLowerLower(d, v[12 + c], v[4 + c])};
    const V back[2] = {hn::ConcatUpperUpper(d, v[8 + c], v[c]), hn::ConcatUpperUpper(d, v[12 + c], v[4 + c])};
    v[c] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(front[1]), front[0]);
    v[4 + c] = hn::OddEvenBlocks(front[1], hn::SwapAdjacentBlocks(front[0]));
    v[8 + c] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(back[1]), back[0]);
    v[12 + c] = hn::OddEvenBlocks(back[1], hn::SwapAdjacentBlocks(back[0]));
  }
}
#endif

// Appends each node reached to the lists of the sources that reach it, and resets its distances.
void Collect(const LocalGraph& graph, BatchedSearch::Scratch& s) {
  constexpr std::size_t all = BatchedSearch::lanes;
  std::uint32_t *node_end[all], *id_end[all], *distance_end[all];
  for (std::size_t k = 0; k < all; ++k) {
    node_end[k] = s.found[k].node.data();
    id_end[k] = s.found[k].id.data();
    distance_end[k] = s.found[k].distance.data();
  }
  // The queue is empty: its memory holds the list of nodes reached.
  std::uint32_t* const nodes = s.queue.data();
  std::size_t count = 0;
  std::uint8_t* const touched = s.touched.data();
  const hn::CappedTag<std::uint8_t, 64> bytes;
  for (std::size_t first = 0; first < s.touched.size(); first += 64) {
    bool any = false;
    for (std::size_t k = 0; k < 64; k += hn::Lanes(bytes))
      any |= !hn::AllTrue(bytes, hn::Eq(hn::LoadU(bytes, touched + first + k), hn::Zero(bytes)));
    if (!any) continue;
    for (std::size_t word = first; word < first + 64; word += 8) {
      std::uint64_t rest;
      std::memcpy(&rest, touched + word, 8);
      for (; rest != 0; rest &= rest - 1)
        nodes[count++] = static_cast<std::uint32_t>(word + hwy::Num0BitsBelowLS1Bit_Nonzero64(rest) / 8);
    }
    std::memset(touched + first, 0, 64);
  }
  const auto distances_of = [&](std::uint32_t node) { return s.distances[node].distance; };
#if HWY_TARGET <= HWY_AVX3
  const hn::FixedTag<std::uint32_t, all> d;
  const auto zero = hn::Zero(d), far = hn::Set(d, BatchedSearch::far), radius = hn::Set(d, unit_radius);
  for (std::size_t first = 0; first < count; first += all) {
    alignas(64) std::uint32_t ids[all] = {}, joined[all] = {};
    hn::Vec<decltype(d)> distance[all];
    const std::size_t here = std::min(all, count - first);
    for (std::size_t n = 0; n < here; ++n) {
      const auto node = nodes[first + n];
      ids[n] = graph.id(node);
      joined[n] = s.joined[node];
      s.joined[node] = 0;
      distance[n] = hn::Load(d, distances_of(node));
      hn::Store(far, d, distances_of(node));
    }
    for (std::size_t n = here; n < all; ++n) distance[n] = far;
    Transpose(d, distance);
    const auto node = hn::LoadU(d, nodes + first), id = hn::Load(d, ids), joins = hn::Load(d, joined);
    for (std::size_t k = 0; k < all; ++k) {
      const auto reached = hn::And(hn::Lt(distance[k], radius), hn::Gt(distance[k], zero));
      const auto edge =
          hn::And(hn::ShiftLeftSame(joins, static_cast<int>(31 - k)), hn::Set(d, BatchedSearch::edge_bit));
      hn::StoreU(hn::Compress(node, reached), d, node_end[k]);
      hn::StoreU(hn::Compress(id, reached), d, id_end[k]);
      hn::StoreU(hn::Compress(hn::Or(distance[k], edge), reached), d, distance_end[k]);
      const auto found = hn::CountTrue(d, reached);
      node_end[k] += found;
      id_end[k] += found;
      distance_end[k] += found;
    }
  }
#else
  for (std::size_t n = 0; n < count; ++n) {
    const auto node = nodes[n], id = graph.id(node);
    const std::uint32_t joined = std::exchange(s.joined[node], std::uint16_t(0));
    auto* const distance = distances_of(node);
    for (std::size_t k = 0; k < all; ++k) {
      const auto known = std::exchange(distance[k], BatchedSearch::far);
      *node_end[k] = node;
      *id_end[k] = id;
      *distance_end[k] = known | (joined >> k & 1) << 31;
      const bool reached = (known < unit_radius) & (known > 0);
      node_end[k] += reached;
      id_end[k] += reached;
      distance_end[k] += reached;
    }
  }
#endif
  for (std::size_t k = 0; k < all; ++k) s.counts[k] = static_cast<std::uint32_t>(node_end[k] - s.found[k].node.data());
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Lengths);
HWY_EXPORT(WithinSupport);
HWY_EXPORT(Search);
HWY_EXPORT(Collect);

void warped_lengths(const double* squared, const double* radius, std::size_t count, std::uint32_t* lengths) {
  HWY_DYNAMIC_DISPATCH(Lengths)(squared, radius, count, lengths);
}

std::size_t edges_within_support(const AdjacencyRow& row, std::uint32_t distance, std::uint32_t* targets,
                                 std::uint32_t* distances) {
  return HWY_DYNAMIC_DISPATCH(WithinSupport)(row, AdjacencyRow::edge_bit, 0, distance, targets, distances);
}

std::size_t neighbors_within_support(const AdjacencyRow& row, std::uint32_t distance, std::uint32_t* targets,
                                     std::uint32_t* distances) {
  constexpr std::uint32_t edge_only = AdjacencyRow::edge_bit | AdjacencyRow::path_bit;
  return HWY_DYNAMIC_DISPATCH(WithinSupport)(row, edge_only, edge_only, distance, targets, distances);
}

void BatchedSearch::run(const LocalGraph& graph, std::span<const std::uint32_t> sources) {
  const std::size_t n = graph.size();
  if (scratch_.distances.size() < n) {
    Lanes unreached;
    std::fill(std::begin(unreached.distance), std::end(unreached.distance), far);
    scratch_.distances.resize(n, unreached);
    scratch_.queued.resize(n, 0);
    scratch_.queue.resize(std::bit_ceil(n + lanes));
    scratch_.joined.resize(n, 0);
    for (auto& found : scratch_.found) {
      found.node.resize(n + lanes);
      found.id.resize(n + lanes);
      found.distance.resize(n + lanes);
    }
  }
  scratch_.touched.resize((n + 63) / 64 * 64, 0);
  Lanes* const distances = scratch_.distances.data();
  std::uint8_t* const touched = scratch_.touched.data();
  std::uint8_t* const queued = scratch_.queued.data();
  std::uint16_t* const joined = scratch_.joined.data();
  std::uint32_t* const queue = scratch_.queue.data();
  const std::uint32_t* const limits = graph.limits().data();
  std::uint32_t tail = 0;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    distances[sources[k]].distance[k] = 0;
    touched[sources[k]] = 1;
    for (const auto edge : graph.edges(sources[k])) {
      distances[edge.to].distance[k] = edge.length;
      touched[edge.to] = 1;
      joined[edge.to] |= static_cast<std::uint16_t>(1u << k);
      const std::uint8_t enters = edge.length < limits[edge.to] && !queued[edge.to];
      queued[edge.to] |= enters;
      queue[tail] = edge.to;
      tail += enters;
    }
  }
  scratch_.tail = tail;
  HWY_DYNAMIC_DISPATCH(Search)(graph, scratch_);
  HWY_DYNAMIC_DISPATCH(Collect)(graph, scratch_);
}

}  // namespace geo
#endif
