// Edges change one row at a time: a row is copied, edited and stored again. Rows of a whole graph
// come from a counting sort of half-edges by node, or from arrays of a file, which are checked.
#include "graph/graph_storage.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using HalfEdges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // (row, other end)

// The index of id in a row, or where it would be inserted.
std::size_t lower_index(const AdjacencyRow& row, std::uint32_t id) {
  return static_cast<std::size_t>(std::lower_bound(row.to.begin(), row.to.end(), id) - row.to.begin());
}

constexpr std::uint16_t edge_only(std::uint32_t warped) {
  return AdjacencyRow::edge_bit | AdjacencyRow::path_bit | AdjacencyRow::bits_of_bound(warped);
}

bool is_live_guide(const GuideSet& guides, std::uint32_t g) { return g < guides.size() && !guides.retired(g); }

HalfEdges half_edges_between(const GuideSet& guides, std::span<const std::array<std::uint32_t, 2>> edges) {
  HalfEdges half_edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [g, h] = edges[e];
    if (!(is_live_guide(guides, g) && h < g && is_live_guide(guides, h)) || (e > 0 && !(edges[e - 1] < edges[e])))
      throw InputError("edge " + std::to_string(e) + " of the graph's guides is out of order or range");
    half_edges.push_back({GraphStorage::guide_id(g), GraphStorage::guide_id(h)});
    half_edges.push_back({GraphStorage::guide_id(h), GraphStorage::guide_id(g)});
  }
  return half_edges;
}

// Checks the rows of a file one after another: each entry must be possible, and the same from both
// ends.
class RowChecker {
 public:
  RowChecker(const NodeSet& nodes, const GraphStorage& graph, const GraphStorage::Arrays& arrays)
      : nodes_(nodes), graph_(graph), in_(arrays), ends_(nodes.size()), next_(nodes.size()) {
    for (std::size_t i = 0, sum = 0; i < nodes.size(); ++i) {
      next_[i] = sum;
      ends_[i] = sum += in_.count[i];
    }
    if (!ends_.empty() && ends_.back() != in_.to.size()) throw InputError("the graph's rows do not fit together");
  }

  // Row i, if it is sound. Rows must be read in order.
  AdjacencyRow read(std::size_t i, HalfEdges& guide_half_edges) {
    const std::size_t begin = i ? ends_[i - 1] : 0, end = ends_[i], first_path = path_;
    for (std::size_t e = begin; e < end; ++e) {
      const std::uint32_t to = in_.to[e];
      const bool to_guide = GraphStorage::is_guide(to);
      const bool in_range =
          to_guide ? is_live_guide(graph_.guides(), GraphStorage::index_of(to)) : to < nodes_.size() && to != i;
      require(in_range && (e == begin || in_.to[e - 1] < to), "is out of order or range", e);
      if (to_guide) {
        const auto length = graph_.warped(nodes_, static_cast<std::uint32_t>(i), to);
        require(in_.bits[e] == edge_only(length), "is not what an edge to a guide is", e);
        longest_edge =
            std::max(longest_edge, std::sqrt(squared_distance(nodes_.position[i], graph_.position(nodes_, to))));
        guide_half_edges.push_back({to, static_cast<std::uint32_t>(i)});
      } else {
        read_entry(i, e);
      }
    }
    // All entries to lower nodes must have been met from there.
    require(next_[i] == end || in_.to[next_[i]] > i, "is not the same from its other end", next_[i]);
    return {in_.to.subspan(begin, end - begin), in_.bits.subspan(begin, end - begin),
            in_.paths.subspan(first_path, path_ - first_path)};
  }
  // After the last row.
  void finish() const {
    if (path_ != in_.paths.size()) throw InputError("the graph has more lengths of paths than it uses");
  }

  std::size_t edges = 0;    // between nodes
  double longest_edge = 0;  // model units

 private:
  static void require(bool right, const char* what, std::size_t e) {
    if (!right) throw InputError("entry " + std::to_string(e) + " of the graph " + what);
  }
  void read_entry(std::size_t i, std::size_t e) {
    const std::uint32_t to = in_.to[e];
    if (AdjacencyRow::has_path(in_.bits[e])) {
      require(path_ < in_.paths.size() && in_.paths[path_] >= 0 && std::isfinite(in_.paths[path_]),
              "has no path's length", e);
      ++path_;
    }
    if (to < i) return;
    const auto back = next_[to]++;
    require(back < ends_[to] && in_.to[back] == i && in_.bits[back] == in_.bits[e],
            "is not the same from its other end", e);
    if (!AdjacencyRow::is_edge(in_.bits[e])) return;
    ++edges;
    longest_edge = std::max(longest_edge, std::sqrt(squared_distance(nodes_.position[i], nodes_.position[to])));
  }

  const NodeSet& nodes_;
  const GraphStorage& graph_;
  const GraphStorage::Arrays& in_;
  std::vector<std::size_t> ends_, next_;  // next_: the entry that each row expects from its other end
  std::size_t path_ = 0;
};

}  // namespace

double plain_unit_for(const NodeSet& nodes) {
  const double largest = nodes.size() == 0 ? 1.0 : *std::max_element(nodes.radius.begin(), nodes.radius.end());
  return std::exp2(std::ceil(std::log2(largest)) - 26);
}

bool GraphStorage::has(std::uint32_t i, std::uint32_t j) const {
  const auto row = entries(i);
  const auto k = lower_index(row, j);
  return k < row.to.size() && row.to[k] == j && AdjacencyRow::is_edge(row.bits[k]);
}

void GraphStorage::add_half_edge(std::uint32_t from, std::uint32_t to, std::uint16_t bound) {
  const auto row = store(from).row(index_of(from));
  const auto k = lower_index(row, to);
  std::vector<std::uint32_t> ids(row.to.begin(), row.to.end());
  std::vector<std::uint16_t> bits(row.bits.begin(), row.bits.end());
  std::vector<float> paths(row.paths.begin(), row.paths.end());
  if (k < ids.size() && ids[k] == to) {
    // The pair are neighbours: now they see each other.
    if (AdjacencyRow::has_path(bits[k]))
      paths.erase(paths.begin() +
                  std::count_if(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(k), AdjacencyRow::has_path));
    bits[k] = static_cast<std::uint16_t>(AdjacencyRow::edge_bit |
                                         std::min<std::uint16_t>(bits[k] & AdjacencyRow::bound_bits, bound));
  } else {
    ids.insert(ids.begin() + static_cast<std::ptrdiff_t>(k), to);
    bits.insert(bits.begin() + static_cast<std::ptrdiff_t>(k), AdjacencyRow::edge_bit | AdjacencyRow::path_bit | bound);
  }
  store(from).set(index_of(from), {ids, bits, paths});
}

bool GraphStorage::add(const NodeSet& nodes, std::uint32_t i, std::uint32_t j) {
  if (has(i, j)) return false;
  const std::uint16_t bound = AdjacencyRow::bits_of_bound(warped(nodes, i, j));
  add_half_edge(i, j, bound);
  add_half_edge(j, i, bound);
  largest_support_ = std::max({largest_support_, radius(nodes, i), radius(nodes, j)});
  longest_edge_ =
      std::max({longest_edge_, largest_support_, std::sqrt(squared_distance(position(nodes, i), position(nodes, j)))});
  edges_ += !is_guide(i) && !is_guide(j);
  return true;
}

std::uint32_t GraphStorage::add_guide(const Guide& guide) {
  const auto id = guide_id(guides_.size());
  guides_.add(guide);
  guide_rows_.resize(guides_.size());
  largest_support_ = std::max(largest_support_, guide.radius);
  longest_edge_ = std::max(longest_edge_, largest_support_);
  return id;
}

void GraphStorage::append_guide_edges(const NodeSet& nodes,
                                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges) {
  for (std::size_t e = 0; e < edges.size();) {
    const auto id = edges[e].first;
    const auto row = store(id).row(index_of(id));
    std::vector<std::uint32_t> to(row.to.begin(), row.to.end());
    std::vector<std::uint16_t> bits(row.bits.begin(), row.bits.end());
    const std::vector<float> paths(row.paths.begin(), row.paths.end());
    for (; e < edges.size() && edges[e].first == id; ++e) {
      to.push_back(edges[e].second);
      bits.push_back(edge_only(warped(nodes, id, edges[e].second)));
    }
    store(id).set(index_of(id), {to, bits, paths});
  }
}

void GraphStorage::lower_bounds(const NodeSet& nodes, NodeId i) {
  const auto row = entries(i.value);
  for (std::size_t e = 0; e < row.to.size(); ++e) {
    if (!AdjacencyRow::is_edge(row.bits[e])) continue;
    const auto j = row.to[e];
    const auto bound = AdjacencyRow::bits_of_bound(warped(nodes, i.value, j));
    if (bound < (row.bits[e] & AdjacencyRow::bound_bits)) rows_.set_bound(i.index(), e, bound);
    const auto other = entries(j);
    const auto at = lower_index(other, i.value);
    // Bounds in rows of guides are lengths of edges. Bounds in rows of nodes are lengths of paths,
    // which may be shorter.
    if (is_guide(j) || bound < (other.bits[at] & AdjacencyRow::bound_bits)) store(j).set_bound(index_of(j), at, bound);
  }
  largest_support_ = std::max(largest_support_, nodes.radius[i.index()]);
  longest_edge_ = std::max(longest_edge_, largest_support_);
}

bool GraphStorage::remove(std::uint32_t i, std::uint32_t j) {
  if (!has(i, j)) return false;
  drop(i, {&j, 1});
  drop(j, {&i, 1});
  return true;
}

void GraphStorage::drop(std::uint32_t id, std::span<const std::uint32_t> others) {
  AdjacencyStore& rows = store(id);
  const auto row = rows.entries(index_of(id));
  const auto bits = rows.bits(index_of(id));
  bool shrinks = false;
  std::size_t k = 0;
  for (const auto other : others) {
    while (row.to[k] != other) ++k;
    if (AdjacencyRow::is_neighbor(bits[k]))
      bits[k] &= static_cast<std::uint16_t>(~AdjacencyRow::edge_bit);
    else
      shrinks = true;
    edges_ -= id < other && !is_guide(other);
  }
  if (!shrinks) return;
  const auto whole = rows.row(index_of(id));
  std::vector<std::uint32_t> to_left;
  std::vector<std::uint16_t> bits_left;
  const std::vector<float> paths(whole.paths.begin(), whole.paths.end());
  auto next = others.begin();
  for (k = 0; k < whole.to.size(); ++k) {
    while (next != others.end() && *next < whole.to[k]) ++next;
    if (next != others.end() && *next == whole.to[k] && !AdjacencyRow::is_neighbor(whole.bits[k])) continue;
    to_left.push_back(whole.to[k]);
    bits_left.push_back(whole.bits[k]);
  }
  rows.set(index_of(id), {to_left, bits_left, paths});
}

std::uint32_t GraphStorage::components(std::vector<std::uint32_t>& component) const {
  component.assign(node_count(), ~0u);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < component.size(); ++i) {
    if (component[i] != ~0u) continue;
    component[i] = count;
    stack.push_back(i);
    while (!stack.empty()) {
      const NodeId at(stack.back());
      stack.pop_back();
      for (const NodeId j : edges(at))
        if (component[j.index()] == ~0u) {
          component[j.index()] = count;
          stack.push_back(j.value);
        }
    }
    ++count;
  }
  return count;
}

GraphStorage GraphStorage::from_edges(const NodeSet& nodes, std::vector<std::pair<NodeId, NodeId>> edges) {
  const std::size_t n = nodes.size();
  GraphStorage graph;
  graph.resize(n);
  graph.set_plain_unit(plain_unit_for(nodes));
  graph.edges_ = edges.size();
  std::vector<std::uint32_t> ends(n + 1, 0);
  for (const auto& [i, j] : edges) {
    ++ends[i.index()];
    ++ends[j.index()];
    graph.longest_edge_ =
        std::max(graph.longest_edge_, squared_distance(nodes.position[i.index()], nodes.position[j.index()]));
  }
  graph.longest_edge_ = std::sqrt(graph.longest_edge_);
  for (const double r : nodes.radius) graph.largest_support_ = std::max(graph.largest_support_, r);
  graph.longest_edge_ = std::max(graph.longest_edge_, graph.largest_support_);
  for (std::size_t i = 0, sum = 0; i <= n; ++i) {
    sum += ends[i];
    ends[i] = static_cast<std::uint32_t>(sum);
  }
  std::vector<std::uint32_t> to(2 * edges.size());
  for (const auto& [i, j] : edges) {
    to[--ends[i.index()]] = j.value;
    to[--ends[j.index()]] = i.value;
  }
  std::vector<std::pair<NodeId, NodeId>>().swap(edges);
  parallel_for(n, 4096, [&](std::size_t begin, std::size_t end) {
    AdjacencyStore::Writer rows(graph.rows_);
    std::vector<std::uint16_t> bits;
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<std::uint32_t> row(to.data() + ends[i], ends[i + 1] - ends[i]);
      std::sort(row.begin(), row.end());
      bits.clear();
      for (const auto j : row) bits.push_back(edge_only(warped_length(nodes, i, j)));
      rows.set(i, {row, bits, {}});
    }
  });
  return graph;
}

GraphStorage GraphStorage::from_arrays(const NodeSet& nodes, double plain_unit, const Arrays& arrays) {
  const std::size_t n = nodes.size();
  if (arrays.count.size() != n || arrays.bits.size() != arrays.to.size())
    throw InputError("the graph's rows do not fit together");
  GraphStorage graph;
  graph.plain_unit_ = plain_unit;
  graph.rows_.resize(n);
  RowChecker checker(nodes, graph, arrays);
  for (const Guide& guide : arrays.guides) graph.add_guide(guide);
  HalfEdges guide_half_edges = half_edges_between(graph.guides_, arrays.guide_edges);
  {
    AdjacencyStore::Writer rows(graph.rows_);
    for (std::size_t i = 0; i < n; ++i) {
      const AdjacencyRow row = checker.read(i, guide_half_edges);
      if (!row.to.empty()) graph.largest_support_ = std::max(graph.largest_support_, nodes.radius[i]);
      rows.set(i, row);
    }
  }
  checker.finish();
  graph.edges_ = checker.edges;
  graph.longest_edge_ = std::max({graph.longest_edge_, checker.longest_edge, graph.largest_support_});
  std::sort(guide_half_edges.begin(), guide_half_edges.end());
  graph.append_guide_edges(nodes, guide_half_edges);
  return graph;
}

std::vector<std::array<std::uint32_t, 2>> GraphStorage::guide_edges() const {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::uint32_t g = 0; g < guides_.size(); ++g)
    for (const auto h : guide_rows_.entries(g).to)
      if (is_guide(h) && index_of(h) < g) edges.push_back({g, index_of(h)});
  return edges;
}

bool GraphStorage::equals(const GraphStorage& other) const {
  if (node_count() != other.node_count() || plain_unit_ != other.plain_unit_ || !(guides_ == other.guides_))
    return false;
  for (std::uint32_t g = 0; g < guides_.size(); ++g)
    if (!(guide_rows_.row(g) == other.guide_rows_.row(g))) return false;
  for (std::size_t i = 0; i < node_count(); ++i)
    if (!(rows_.row(i) == other.rows_.row(i))) return false;
  return true;
}

}  // namespace geo
