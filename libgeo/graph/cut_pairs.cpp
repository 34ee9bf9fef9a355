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

std::size_t guides_in(const AdjacencyRow& row) {
  std::size_t count = 0;
  while (count < row.to.size() && GraphStorage::is_guide(row.to[row.to.size() - 1 - count])) ++count;
  return count;
}

struct Pair {
  std::uint32_t a, b;  // numbers of ids
  std::uint16_t bits;
};

// Pairs are put in rows from both ends, in any order. Then each entry goes to the row of its other
// end, rows ascending: these are the same rows, but in order.
CutPairs rows_of(std::span<const Pair> pairs, IdNumbering& ids, const std::vector<bool>& above) {
  CutPairs severed;
  std::vector<std::uint32_t> next(ids.size(), 0);  // how many entries, then where the next one goes
  for (const Pair& p : pairs) ++next[p.a], ++next[p.b];
  std::uint32_t sum = 0;
  ids.each([&](std::uint32_t id, std::uint32_t k) {
    const auto count = std::exchange(next[k], sum);
    severed.rows.push_back({id, sum, sum + count, above[k]});
    sum += count;
  });
  std::vector<CutPairs::Entry> mixed(sum);
  auto next_mixed = next;
  for (const Pair& p : pairs) mixed[next_mixed[p.a]++] = {p.b, p.bits}, mixed[next_mixed[p.b]++] = {p.a, p.bits};
  severed.entries.resize(sum);
  for (const auto& row : severed.rows)
    for (auto e = row.begin; e < row.end; ++e) severed.entries[next[mixed[e].to]++] = {row.id, mixed[e].bits};
  return severed;
}

}  // namespace

CutPairs find_cut_pairs(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                        std::span<const Corners> faces) {
  const TriangleBvh tree(faces);
  const Near near = find_cut_candidates(nodes, graph, grid, first_new, faces, tree);
  if (near.ids.empty()) return {};
  thread_local IdSet has_asked;
  thread_local IdNumbering number;  // of those that lose something
  has_asked.clear();
  number.clear();
  std::vector<Pair> pairs;
  std::vector<bool> is_above;  // by number
  std::vector<std::uint32_t> asked;
  std::vector<Vec3> ends;
  std::vector<std::uint8_t> blocked;
  for (std::uint32_t at = 0; at < near.ids.size(); ++at) {
    constexpr std::size_t ahead = 4;
    if (at + 2 * ahead < near.ids.size())
      graph.store(near.ids[at + 2 * ahead]).prefetch_location(GraphStorage::index_of(near.ids[at + 2 * ahead]));
    if (at + ahead < near.ids.size())
      graph.store(near.ids[at + ahead]).prefetch(GraphStorage::index_of(near.ids[at + ahead]));
    const auto i = near.ids[at];
    const auto row = graph.entries(i);
    // What is not beyond the slab on the same side.
    const Slab& slab = near.slab[near.slabs[at]];
    const double height = slab.height(graph.position(nodes, i));
    const double least = height < slab.from ? slab.from : -infinity, most = height > slab.to ? slab.to : infinity;
    asked.resize(std::max(asked.size(), row.to.size()));
    std::size_t count = 0;
    const auto ask = [&](std::uint32_t k, const Vec3& x) {
      const double h = slab.height(x);
      asked[count] = k;
      count += (h >= least) & (h <= most);
    };
    std::uint32_t k = 0;
    for (const auto end = static_cast<std::uint32_t>(row.to.size() - guides_in(row)); k < end; ++k)
      ask(k, nodes.position[row.to[k]]);
    for (; k < row.to.size(); ++k) ask(k, graph.position(nodes, row.to[k]));
    ends.clear();
    std::size_t kept = 0;
    for (std::size_t a = 0; a < count; ++a) {
      const auto j = row.to[asked[a]];
      asked[kept] = asked[a];
      kept += !has_asked.has(j);
    }
    for (std::size_t a = 0; a < kept; ++a) ends.push_back(graph.position(nodes, row.to[asked[a]]));
    has_asked.add(i);
    blocked.resize(kept);
    tree.blocks(graph.position(nodes, i), ends, blocked.data());
    const auto first = std::find(blocked.begin(), blocked.end(), 1) - blocked.begin();
    if (static_cast<std::size_t>(first) == kept) continue;
    const auto number_of = [&](std::uint32_t id) {
      const auto it = number.add(id);
      if (it == is_above.size()) is_above.push_back(2 * slab.height(graph.position(nodes, id)) > slab.from + slab.to);
      return it;
    };
    const auto mine = number_of(i);
    for (auto a = static_cast<std::size_t>(first); a < kept; ++a)
      if (blocked[a]) pairs.push_back({mine, number_of(row.to[asked[a]]), row.bits[asked[a]]});
  }
  return rows_of(pairs, number, is_above);
}

}  // namespace geo
