// A label-correcting search from all sources at once, by lower bounds of lengths, finds nodes and
// edges. Then nodes are numbered by id, edges get exact lengths, and a counting sort by class of
// length orders the edges of each node.
#include "graph/local_graph.h"

#include <algorithm>
#include <utility>

#include "graph/batched_search.h"

namespace geo {
inline std::uint32_t LocalGraph::discover(std::uint32_t id) {
  const auto number = numbers_.add(id);
  if (number == discovered_) {
    if (discovered_ == discoveries_.size()) {
      discoveries_.resize(2 * discovered_ + 64);
      queued_.resize(discoveries_.size(), 0);
    }
    discoveries_[discovered_++] = {.id = id, .distance = unit_radius, .begin = 0, .end = 0};
  }
  return number;
}

// Which nodes and edges: a search from all sources at once, with bounds from below in place of
// lengths.
void LocalGraph::explore(const GraphStorage& graph, std::span<const std::uint32_t> sources) {
  const auto count = static_cast<std::uint32_t>(sources.size());
  numbers_.clear();
  discovered_ = 0;
  for (const auto id : sources) discover(id);
  std::size_t used = 0, tail = 0;
  if (queue_.size() < count) queue_.resize(2 * count);
  for (std::uint32_t number = 0; number < count; ++number) {
    queue_[tail++] = number;
    discoveries_[number].distance = 0;
    queued_[number] = 1;
  }
  const auto may_lead_on = [&](std::uint32_t number) {
    const Discovery& d = discoveries_[number];
    return d.distance + AdjacencyRow::bound(graph.store(d.id).lowest_bound(GraphStorage::index_of(d.id))) < unit_radius;
  };
  const auto prefetch_location = [&](std::uint32_t id) {
    graph.store(id).prefetch_location(GraphStorage::index_of(id));
  };
  const auto prefetch = [&](std::uint32_t id) { graph.store(id).prefetch(GraphStorage::index_of(id)); };
  for (std::size_t at = 0; at < tail; ++at) {
    const auto number = queue_[at];
    queued_[number] = 0;
    // Rows to prefetch ahead: memory answers while they are handled.
    constexpr std::size_t ahead = 6;
    if (at + 2 * ahead < tail) prefetch_location(discoveries_[queue_[at + 2 * ahead]].id);
    if (at + ahead < tail && may_lead_on(queue_[at + ahead])) prefetch(discoveries_[queue_[at + ahead]].id);
    if (number >= count && !may_lead_on(number)) continue;
    const auto distance = discoveries_[number].distance;
    const auto row = graph.entries(discoveries_[number].id);
    const auto size = row.to.size();
    constexpr std::size_t vector = 16;
    if (targets_.size() < used + size + vector) targets_.resize(2 * used + size + vector);
    if (next_.size() < size + vector) next_.resize(2 * size + vector);
    if (queue_.size() < tail + size) queue_.resize(2 * tail + size);
    auto* const targets = targets_.data() + used;
    const std::size_t edges = edges_within_support(row, distance, targets, next_.data());
    for (std::size_t k = 0; k < edges; ++k) {
      const auto to = targets[k] = discover(targets[k]);
      auto& known = discoveries_[to].distance;
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
  if (length_.size() < count + 16) {
    squared_.resize(2 * count + 16, 1);
    radius_.resize(2 * count + 16, 1);
    length_.resize(2 * count + 16);
    to_.resize(length_.size());
    class_.resize(length_.size());
  }
  const Point& p = points_[local_[number]];
  for (std::size_t k = 0; k < count; ++k) {
    to_[k] = local_[targets[k]];
    const Point& q = points_[to_[k]];
    const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;  // as squared_distance()
    squared_[k] = (x * x + y * y) + z * z;
    radius_[k] = std::max(p.radius, q.radius);
  }
  warped_lengths(squared_.data(), radius_.data(), count, length_.data());
  // A counting sort into classes. The last class holds edges that lead to no neighbour; it is
  // dropped.
  constexpr std::uint32_t classes = unit_radius >> class_shift;
  const auto limit = unit_radius - from.distance;
  std::uint32_t shortest = unit_radius, longest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    shortest = std::min(shortest, length_[k]);
    longest = std::max(longest, length_[k]);
    class_[k] = length_[k] < limit ? length_[k] >> class_shift : classes;
  }
  std::array<std::uint32_t, classes + 1> begin{};
  for (std::size_t k = 0; k < count; ++k) ++begin[class_[k]];
  std::uint32_t sum = first_.back();
  for (auto& c : begin) sum += std::exchange(c, sum);
  if (edges_.size() < sum) edges_.resize(2 * sum);
  for (std::size_t k = 0; k < count; ++k) edges_[begin[class_[k]]++] = {to_[k], length_[k]};
  first_.push_back(begin[classes - 1]);
  limit_.push_back(unit_radius - shortest);
  if (source)
    edge_only_[number] =
        longest >= unit_radius || std::any_of(to_.begin(), to_.begin() + static_cast<std::ptrdiff_t>(count),
                                              [&](auto to) { return to >= nodes_; });
}

void LocalGraph::gather(const NodeSet& nodes, const GraphStorage& graph, std::span<const std::uint32_t> sources) {
  explore(graph, sources);
  nodes_ = 0;
  id_.resize(discovered_);
  local_.resize(discovered_);
  points_.resize(discovered_);
  number_.resize(discovered_);
  std::uint32_t local = 0;
  numbers_.each([&](std::uint32_t id, std::uint32_t number) {
    id_[local] = id;
    number_[local] = number;
    local_[number] = local;
    const Vec3& p = graph.position(nodes, id);
    points_[local] = {.x = p.x(), .y = p.y(), .z = p.z(), .radius = graph.radius(nodes, id)};
    nodes_ += !GraphStorage::is_guide(id);
    ++local;
  });
  first_.assign(1, 0);
  limit_.clear();
  edge_only_.assign(sources.size(), 0);
  for (const auto number : number_) measure(number, number < sources.size());
}

}  // namespace geo
