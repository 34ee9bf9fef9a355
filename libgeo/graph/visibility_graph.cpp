#include "kerf/graph.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "kerf/error.h"

namespace geo {
namespace {

// Where j is or would be in a row.
std::size_t place_of(const RowView& row, NodeId j) {
  return static_cast<std::size_t>(std::lower_bound(row.to.begin(), row.to.end(), j.value) - row.to.begin());
}

}  // namespace

double plain_unit_for(const NodeSet& nodes) {
  const double most = nodes.size() == 0 ? 1.0 : *std::max_element(nodes.radius.begin(), nodes.radius.end());
  return std::exp2(std::ceil(std::log2(most)) - 26);
}

std::size_t VisibilityGraph::neighbor_count(NodeId i) const {
  const auto row = rows_.entries(i.index());
  return static_cast<std::size_t>(std::count_if(row.bits.begin(), row.bits.end(), is_neighbor));
}

bool VisibilityGraph::has(NodeId i, NodeId j) const {
  const auto row = entries(i.value);
  const auto k = place_of(row, j);
  return k < row.to.size() && row.to[k] == j.value && is_edge(row.bits[k]);
}

bool VisibilityGraph::add(const NodeSet& nodes, NodeId i, NodeId j) {
  if (has(i, j)) return false;
  const std::uint16_t bound = bits_of_bound(warped(nodes, i.value, j.value)), fresh = edge_bit | path_bit | bound;
  const auto put = [&](NodeId from, NodeId to) {
    const auto row = store(from.value).row(place(from.value));
    const auto k = place_of(row, to);
    std::vector<std::uint32_t> ids(row.to.begin(), row.to.end());
    std::vector<std::uint16_t> bits(row.bits.begin(), row.bits.end());
    std::vector<float> paths(row.paths.begin(), row.paths.end());
    if (k < ids.size() && ids[k] == to.value) {
      // Neighbours already: now they see each other.
      if (RowStore::has_path(bits[k]))
        paths.erase(paths.begin() +
                    std::count_if(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(k), RowStore::has_path));
      bits[k] = static_cast<std::uint16_t>(edge_bit | std::min<std::uint16_t>(bits[k] & bound_bits, bound));
    } else {
      ids.insert(ids.begin() + static_cast<std::ptrdiff_t>(k), to.value);
      bits.insert(bits.begin() + static_cast<std::ptrdiff_t>(k), fresh);
    }
    store(from.value).set(place(from.value), {ids, bits, paths});
  };
  put(i, j), put(j, i);
  support_ = std::max({support_, radius(nodes, i.value), radius(nodes, j.value)});
  reach_ =
      std::max({reach_, support_, std::sqrt(squared_distance(position(nodes, i.value), position(nodes, j.value)))});
  edges_ += !is_guide(i.value) && !is_guide(j.value);
  return true;
}

std::uint32_t VisibilityGraph::add_guide(const Guide& guide) {
  const auto id = first_guide + guides_.size();
  guides_.add(guide);
  guide_rows_.resize(guides_.size());
  support_ = std::max(support_, guide.radius);
  reach_ = std::max(reach_, support_);
  return id;
}

void VisibilityGraph::append_guide_edges(const NodeSet& nodes,
                                         std::span<const std::pair<std::uint32_t, std::uint32_t>> edges) {
  for (std::size_t e = 0; e < edges.size();) {
    const auto id = edges[e].first;
    const auto row = store(id).row(place(id));
    std::vector<std::uint32_t> to(row.to.begin(), row.to.end());
    std::vector<std::uint16_t> bits(row.bits.begin(), row.bits.end());
    const std::vector<float> paths(row.paths.begin(), row.paths.end());
    for (; e < edges.size() && edges[e].first == id; ++e) {
      to.push_back(edges[e].second);
      bits.push_back(edge_bit | path_bit | bits_of_bound(warped(nodes, id, edges[e].second)));
    }
    store(id).set(place(id), {to, bits, paths});
  }
}

void VisibilityGraph::resize_node(const NodeSet& nodes, NodeId i) {
  const auto row = entries(i.value);
  for (std::size_t e = 0; e < row.to.size(); ++e) {
    if (!is_edge(row.bits[e])) continue;
    const auto j = row.to[e];
    const auto bound = bits_of_bound(warped(nodes, i.value, j));
    if (bound < (row.bits[e] & bound_bits)) rows_.set_bound(i.index(), e, bound);
    const auto other = entries(j);
    const auto at = place_of(other, i);
    // Rows of guides are lengths of edges; those of nodes, paths, which may be shorter.
    if (is_guide(j) || bound < (other.bits[at] & bound_bits)) store(j).set_bound(place(j), at, bound);
  }
  support_ = std::max(support_, nodes.radius[i.index()]);
  reach_ = std::max(reach_, support_);
}

bool VisibilityGraph::remove(NodeId i, NodeId j) {
  if (!has(i, j)) return false;
  drop(i.value, {&j.value, 1}), drop(j.value, {&i.value, 1});
  return true;
}

void VisibilityGraph::drop(std::uint32_t id, std::span<const std::uint32_t> others) {
  RowStore& rows = store(id);
  const auto row = rows.entries(place(id));
  const auto bits = rows.bits(place(id));
  bool shrinks = false;
  std::size_t k = 0;
  for (const auto other : others) {
    while (row.to[k] != other) ++k;
    if (is_neighbor(bits[k]))
      bits[k] &= static_cast<std::uint16_t>(~edge_bit);
    else
      shrinks = true;
    edges_ -= id < other && !is_guide(other);
  }
  if (!shrinks) return;
  const auto whole = rows.row(place(id));
  std::vector<std::uint32_t> to_left;
  std::vector<std::uint16_t> bits_left;
  const std::vector<float> paths(whole.paths.begin(), whole.paths.end());
  auto next = others.begin();
  for (k = 0; k < whole.to.size(); ++k) {
    while (next != others.end() && *next < whole.to[k]) ++next;
    if (next != others.end() && *next == whole.to[k] && !is_neighbor(whole.bits[k])) continue;
    to_left.push_back(whole.to[k]), bits_left.push_back(whole.bits[k]);
  }
  rows.set(place(id), {to_left, bits_left, paths});
}

std::uint32_t VisibilityGraph::components(std::vector<std::uint32_t>& of) const {
  of.assign(node_count(), ~0u);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < of.size(); ++i) {
    if (of[i] != ~0u) continue;
    of[i] = count;
    stack.push_back(i);
    while (!stack.empty()) {
      const NodeId at(stack.back());
      stack.pop_back();
      for (const NodeId j : edges(at))
        if (of[j.index()] == ~0u) of[j.index()] = count, stack.push_back(j.value);
    }
    ++count;
  }
  return count;
}

VisibilityGraph VisibilityGraph::from_rows(const NodeSet& nodes, double plain_unit,
                                           std::span<const std::uint32_t> count, std::span<const std::uint32_t> to,
                                           std::span<const std::uint16_t> bits, std::span<const float> paths,
                                           std::span<const Guide> guides,
                                           std::span<const std::array<std::uint32_t, 2>> guide_edges) {
  const std::size_t n = nodes.size();
  const auto require = [](bool right, const char* what, std::size_t e) {
    if (!right) throw InputError("entry " + std::to_string(e) + " of the graph " + what);
  };
  if (count.size() != n || bits.size() != to.size()) throw InputError("the graph's rows do not fit together");
  VisibilityGraph graph;
  graph.plain_unit_ = plain_unit;
  graph.rows_.resize(n);
  std::vector<std::size_t> ends(n), next(n);  // next: what each row expects from the other ends, which come in order
  for (std::size_t i = 0, sum = 0; i < n; ++i) next[i] = sum, ends[i] = sum += count[i];
  if (n > 0 && ends.back() != to.size()) throw InputError("the graph's rows do not fit together");
  for (const Guide& guide : guides) graph.add_guide(guide);
  const auto there = [&](std::uint32_t g) { return g < guides.size() && !graph.guides_.retired(g); };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_guides;  // edges, from their ends
  for (std::size_t e = 0; e < guide_edges.size(); ++e) {
    const auto [g, h] = guide_edges[e];
    if (!(there(g) && h < g && there(h)) || (e > 0 && !(guide_edges[e - 1] < guide_edges[e])))
      throw InputError("edge " + std::to_string(e) + " of the graph's guides is out of order or range");
    of_guides.push_back({first_guide + g, first_guide + h}), of_guides.push_back({first_guide + h, first_guide + g});
  }
  RowStore::Writer rows(graph.rows_);
  std::size_t path = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t begin = i ? ends[i - 1] : 0, end = ends[i], first_path = path;
    for (std::size_t e = begin; e < end; ++e) {
      const bool to_guide = is_guide(to[e]);
      require((to_guide ? there(place(to[e])) : to[e] < n && to[e] != i) && (e == begin || to[e - 1] < to[e]),
              "is out of order or range", e);
      if (to_guide) {
        const auto length = graph.warped(nodes, static_cast<std::uint32_t>(i), to[e]);
        require(bits[e] == (edge_bit | path_bit | bits_of_bound(length)), "is not what an edge to a guide is", e);
        graph.reach_ =
            std::max(graph.reach_, std::sqrt(squared_distance(nodes.position[i], graph.position(nodes, to[e]))));
        of_guides.push_back({to[e], static_cast<std::uint32_t>(i)});
        continue;
      }
      if (RowStore::has_path(bits[e])) {
        require(path < paths.size() && paths[path] >= 0 && std::isfinite(paths[path]), "has no path's length", e);
        ++path;
      }
      if (to[e] < i) continue;
      const auto back = next[to[e]]++;
      require(back < ends[to[e]] && to[back] == i && bits[back] == bits[e], "is not the same from its other end", e);
      if (!is_edge(bits[e])) continue;
      ++graph.edges_;
      graph.reach_ = std::max(graph.reach_, std::sqrt(squared_distance(nodes.position[i], nodes.position[to[e]])));
    }
    if (begin < end) graph.support_ = std::max(graph.support_, nodes.radius[i]);
    // All entries to lower nodes must have been met from there.
    require(next[i] == end || to[next[i]] > i, "is not the same from its other end", next[i]);
    rows.set(i, {to.subspan(begin, end - begin), bits.subspan(begin, end - begin),
                 paths.subspan(first_path, path - first_path)});
  }
  graph.reach_ = std::max(graph.reach_, graph.support_);
  if (path != paths.size()) throw InputError("the graph has more lengths of paths than it uses");
  std::sort(of_guides.begin(), of_guides.end());
  graph.append_guide_edges(nodes, of_guides);
  return graph;
}

std::vector<std::array<std::uint32_t, 2>> VisibilityGraph::guide_edges() const {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::uint32_t g = 0; g < guides_.size(); ++g)
    for (const auto h : guide_rows_.entries(g).to)
      if (is_guide(h) && place(h) < g) edges.push_back({g, place(h)});
  return edges;
}

bool operator==(const VisibilityGraph& a, const VisibilityGraph& b) {
  if (a.node_count() != b.node_count() || a.plain_unit_ != b.plain_unit_ || !(a.guides_ == b.guides_)) return false;
  for (std::uint32_t g = 0; g < a.guides_.size(); ++g)
    if (!(a.guide_rows_.row(g) == b.guide_rows_.row(g))) return false;
  for (std::size_t i = 0; i < a.node_count(); ++i)
    if (!(a.rows_.row(i) == b.rows_.row(i))) return false;
  return true;
}

}  // namespace geo
