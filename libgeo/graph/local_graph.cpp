#include "graph/local_graph.h"

#include <algorithm>

#include "graph/lane_search.h"

namespace geo {
inline std::uint32_t LocalGraph::discover(std::uint32_t id) {
  const auto number = map_.add(id) + run_;
  if (number == discovered_) {
    if (discovered_ == discoveries_.size()) discoveries_.resize(2 * discovered_ + 64), queued_.resize(discoveries_.size(), 0);
    discoveries_[discovered_++] = {id, unit_radius, 0, 0};
  }
  return number;
}

// Which nodes and edges: a search from all sources at once, with bounds from below in place of lengths.
void LocalGraph::explore(const VisibilityGraph& graph, std::span<const std::uint32_t> sources) {
  // Sources that are a run of ids are found without the table.
  const std::uint32_t base = sources.empty() ? 0 : sources.front(), count = static_cast<std::uint32_t>(sources.size());
  const bool is_run = !sources.empty() && sources.back() - base + 1 == count;
  const auto expected = std::max<std::size_t>(4 * count, map_.ids().size());
  map_.clear(expected);
  run_ = 0, discovered_ = 0;
  for (const auto id : sources) discover(id);
  if (is_run) map_.clear(expected), run_ = count;
  std::size_t used = 0, tail = 0;
  if (queue_.size() < count) queue_.resize(2 * count);
  for (std::uint32_t number = 0; number < count; ++number) queue_[tail++] = number, discoveries_[number].reach = 0, queued_[number] = 1;
  const auto leads_on = [&](std::uint32_t number) {
    const Discovery& d = discoveries_[number];
    return d.reach + VisibilityGraph::bound(graph.store(d.id).least(VisibilityGraph::place(d.id))) < unit_radius;
  };
  const auto prefetch_place = [&](std::uint32_t id) { graph.store(id).prefetch_place(VisibilityGraph::place(id)); };
  const auto prefetch = [&](std::uint32_t id) { graph.store(id).prefetch(VisibilityGraph::place(id)); };
  for (std::size_t at = 0; at < tail; ++at) {
    const auto number = queue_[at];
    queued_[number] = 0;
    constexpr std::size_t ahead = 6;
    if (at + 2 * ahead < tail) prefetch_place(discoveries_[queue_[at + 2 * ahead]].id);
    if (at + ahead < tail && leads_on(queue_[at + ahead])) prefetch(discoveries_[queue_[at + ahead]].id);
    if (number >= count && !leads_on(number)) continue;
    const auto reach = discoveries_[number].reach;
    const auto row = graph.entries(discoveries_[number].id);
    const auto size = row.to.size();
    constexpr std::size_t vector = 16;
    if (targets_.size() < used + size + vector) targets_.resize(2 * used + size + vector);
    if (next_.size() < size + vector) next_.resize(2 * size + vector);
    if (queue_.size() < tail + size) queue_.resize(2 * tail + size);
    auto* const targets = targets_.data() + used;
    const std::size_t edges = edges_that_lead_on(row, reach, targets, next_.data());
    for (std::size_t k = 0; k < edges; ++k) {
      const auto in_run = targets[k] - base;
      if (in_run < run_) {  // a source: nothing is nearer
        targets[k] = in_run;
        continue;
      }
      const auto to = targets[k] = discover(targets[k]);
      auto& known = discoveries_[to].reach;
      const std::uint8_t enters = (next_[k] < known) & (queued_[to] ^ 1);
      known = std::min(known, next_[k]);
      queued_[to] |= enters;
      queue_[tail] = to;
      tail += enters;
    }
    discoveries_[number].begin = static_cast<std::uint32_t>(used);
    discoveries_[number].end = static_cast<std::uint32_t>(used += edges);
  }
}

void LocalGraph::measure(std::uint32_t number, bool source) {
  const Discovery& from = discoveries_[number];
  const std::size_t count = from.end - from.begin;
  const auto* targets = targets_.data() + from.begin;
  if (length_.size() < count + 16) squared_.resize(2 * count + 16, 1), radius_.resize(2 * count + 16, 1), length_.resize(2 * count + 16);
  const Place& p = places_[place_[number]];
  for (std::size_t k = 0; k < count; ++k) {
    const Place& q = places_[place_[targets[k]]];
    const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;  // as squared_distance()
    squared_[k] = (x * x + y * y) + z * z;
    radius_[k] = std::max(p.radius, q.radius);
  }
  warped_lengths(squared_.data(), radius_.data(), count, length_.data());
  // A counting sort into classes, without the edges that lead nowhere.
  constexpr std::size_t classes = unit_radius >> class_shift;
  std::array<std::uint32_t, classes + 1> begin{};
  const auto most = unit_radius - from.reach;
  std::uint32_t shortest = unit_radius;
  bool bare = false;
  for (std::size_t k = 0; k < count; ++k) {
    shortest = std::min(shortest, length_[k]);
    bare |= length_[k] >= unit_radius || place_[targets[k]] >= nodes_;
    begin[length_[k] < most ? length_[k] >> class_shift : classes] += 1;
  }
  std::uint32_t sum = static_cast<std::uint32_t>(edges_.size());
  for (std::size_t c = 0; c < classes; ++c) {
    const auto size = begin[c];
    begin[c] = sum;
    sum += size;
  }
  edges_.resize(sum);
  for (std::size_t k = 0; k < count; ++k)
    if (length_[k] < most) edges_[begin[length_[k] >> class_shift]++] = {place_[targets[k]], length_[k]};
  limit_.push_back(unit_radius - std::min(shortest, unit_radius));
  if (source) bare_edges_[number] = bare;
}

void LocalGraph::gather(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const std::uint32_t> sources) {
  explore(graph, sources);
  order_.resize(discovered_);
  for (std::uint32_t number = 0; number < discovered_; ++number) order_[number] = std::uint64_t(discoveries_[number].id) << 32 | number;
  // Sources are in order already; the others are put between them.
  const auto others = order_.begin() + static_cast<std::ptrdiff_t>(sources.size());
  std::sort(others, order_.end());
  merged_.resize(order_.size());
  std::merge(order_.begin(), others, others, order_.end(), merged_.begin());
  order_.swap(merged_);
  nodes_ = 0;
  id_.resize(discovered_), place_.resize(discovered_), places_.resize(discovered_);
  for (std::uint32_t local = 0; local < discovered_; ++local) {
    const auto id = static_cast<std::uint32_t>(order_[local] >> 32);
    id_[local] = id, place_[static_cast<std::uint32_t>(order_[local])] = local;
    const Vec3& p = graph.position(nodes, id);
    places_[local] = {p.x(), p.y(), p.z(), graph.radius(nodes, id)};
    nodes_ += !VisibilityGraph::is_guide(id);
  }
  first_.clear(), limit_.clear(), edges_.clear();
  bare_edges_.assign(sources.size(), 0);
  for (const auto entry : order_) {
    first_.push_back(static_cast<std::uint32_t>(edges_.size()));
    const auto number = static_cast<std::uint32_t>(entry);
    measure(number, number < sources.size());
  }
  first_.push_back(static_cast<std::uint32_t>(edges_.size()));
}

}  // namespace geo
