// From each cut candidate (cut_candidates.h), segments to the entries of its row are tested exactly
// against a BVH of the new faces. Left out are entries beyond the slab on the candidate's side, and
// those that an earlier candidate has tested.
#include "graph/cut_pairs.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/bvh.h"
#include "graph/cut_candidates.h"
#include "graph/id_numbering.h"
#include "graph/id_set.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Number of guides in a row. Ids ascend, and those of guides are the largest.
std::size_t guides_in(const AdjacencyRow& row) {
  std::size_t count = 0;
  while (count < row.to.size() && GraphStorage::is_guide(row.to[row.to.size() - 1 - count])) ++count;
  return count;
}

struct Pair {
  std::uint32_t a, b;  // numbers that IdNumbering gave to the ids, not ids
  std::uint16_t bits;
};

// Sorts pairs into rows without comparing: first each pair goes into the rows of both ends, in any
// order; then each entry goes to the row of its other end, rows ascending. That gives the same
// rows, sorted.
CutPairs rows_of(std::span<const Pair> pairs, IdNumbering& ids, const std::vector<bool>& above) {
  CutPairs cut;
  std::vector<std::uint32_t> next(ids.size(), 0);  // number of entries, then the index of the next one
  for (const Pair& p : pairs) {
    ++next[p.a];
    ++next[p.b];
  }
  std::uint32_t sum = 0;
  ids.each([&](std::uint32_t id, std::uint32_t k) {
    const auto count = std::exchange(next[k], sum);
    cut.rows.push_back({.id = id, .begin = sum, .end = sum + count, .above = above[k]});
    sum += count;
  });
  std::vector<CutPairs::Entry> mixed(sum);
  auto next_mixed = next;
  for (const Pair& p : pairs) {
    mixed[next_mixed[p.a]++] = {p.b, p.bits};
    mixed[next_mixed[p.b]++] = {p.a, p.bits};
  }
  cut.entries.resize(sum);
  for (const auto& row : cut.rows)
    for (auto e = row.begin; e < row.end; ++e) cut.entries[next[mixed[e].to]++] = {row.id, mixed[e].bits};
  return cut;
}

// Collects cut pairs around one candidate after the other.
class CutPairSearch {
 public:
  CutPairSearch(const NodeSet& nodes, const GraphStorage& graph, const TriangleBvh& tree)
      : nodes_(nodes), graph_(graph), tree_(tree), tested_(thread_set()), numbers_(thread_numbering()) {
    tested_.clear();
    numbers_.clear();
  }
  void add_pairs_of(std::uint32_t i, const Slab& slab) {
    const auto row = graph_.entries(i);
    const std::size_t count = select_entries(i, row, slab);
    tested_.add(i);
    ends_.clear();
    for (std::size_t e = 0; e < count; ++e) ends_.push_back(graph_.position(nodes_, row.to[selected_[e]]));
    blocked_.resize(count);
    tree_.blocks(graph_.position(nodes_, i), ends_, blocked_.data());
    const auto first = static_cast<std::size_t>(std::find(blocked_.begin(), blocked_.end(), 1) - blocked_.begin());
    if (first == count) return;
    const auto number = number_of(i, slab);
    for (auto e = first; e < count; ++e)
      if (blocked_[e]) pairs_.push_back({number, number_of(row.to[selected_[e]], slab), row.bits[selected_[e]]});
  }
  CutPairs finish() { return rows_of(pairs_, numbers_, above_); }

 private:
  // Memory is kept from one update to the next. So at most one search lives on a thread at a time.
  static IdSet& thread_set() {
    thread_local IdSet set;
    return set;
  }
  static IdNumbering& thread_numbering() {
    thread_local IdNumbering numbering;
    return numbering;
  }
  // Selects the entries that are not beyond the slab on i's side, and were not tested from their
  // other end. Returns their number.
  std::size_t select_entries(std::uint32_t i, const AdjacencyRow& row, const Slab& slab) {
    const double height = slab.height(graph_.position(nodes_, i));
    const double least = height < slab.from ? slab.from : -infinity, most = height > slab.to ? slab.to : infinity;
    selected_.resize(std::max(selected_.size(), row.to.size()));
    std::size_t count = 0;
    const auto select = [&](std::uint32_t k, const Vec3& x) {
      const double h = slab.height(x);
      selected_[count] = k;  // written always, counted only within the slab: no branch
      count += (h >= least) & (h <= most);
    };
    // Nodes first, whose positions need no test for a guide; then the guides at the row's end.
    std::uint32_t k = 0;
    for (const auto end = static_cast<std::uint32_t>(row.to.size() - guides_in(row)); k < end; ++k)
      select(k, nodes_.position[row.to[k]]);
    for (; k < row.to.size(); ++k) select(k, graph_.position(nodes_, row.to[k]));
    std::size_t kept = 0;
    for (std::size_t e = 0; e < count; ++e) {
      const auto j = row.to[selected_[e]];
      selected_[kept] = selected_[e];
      kept += !tested_.has(j);
    }
    return kept;
  }
  std::uint32_t number_of(std::uint32_t id, const Slab& slab) {
    const auto number = numbers_.add(id);
    if (number == above_.size()) above_.push_back(2 * slab.height(graph_.position(nodes_, id)) > slab.from + slab.to);
    return number;
  }

  const NodeSet& nodes_;
  const GraphStorage& graph_;
  const TriangleBvh& tree_;
  IdSet& tested_;
  IdNumbering& numbers_;  // of ids with a cut pair
  std::vector<Pair> pairs_;
  std::vector<bool> above_;  // by number
  std::vector<std::uint32_t> selected_;
  std::vector<Vec3> ends_;
  std::vector<std::uint8_t> blocked_;
};

}  // namespace

CutPairs find_cut_pairs(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                        std::span<const Corners> faces) {
  const TriangleBvh tree(faces);
  const CutCandidates candidates = find_cut_candidates(nodes, graph, grid, first_new, faces, tree);
  const auto& ids = candidates.ids;
  if (ids.empty()) return {};
  CutPairSearch search(nodes, graph, tree);
  for (std::uint32_t at = 0; at < ids.size(); ++at) {
    graph.prefetch_after(at, ids.size(), [&](std::size_t i) { return ids[i]; });
    search.add_pairs_of(ids[at], candidates.slab[candidates.slabs[at]]);
  }
  return search.finish();
}

}  // namespace geo
