#include <algorithm>
#include <catch2/catch.hpp>

#include "cases.h"
#include "clouds.h"
#include "graph/nearest.h"
#include "graph/spanning_tree.h"
#include "kerf/parallel.h"
#include "simd_targets.h"

using namespace geo;

namespace {

std::vector<NodeId> by_full_scan(const std::vector<Vec3>& x, int k) {
  std::vector<NodeId> rows;
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::uint32_t j = 0; j < x.size(); ++j)
      if (j != i) all.push_back({squared_distance(x[i], x[j]), j});
    std::sort(all.begin(), all.end());
    for (std::size_t q = 0; q < static_cast<std::size_t>(k); ++q)
      rows.push_back(q < all.size() ? NodeId(all[q].second) : NodeId());
  }
  return rows;
}

bool rows_are(const UninitializedArray<NodeId>& rows, const std::vector<NodeId>& expected) {
  return std::equal(rows.begin(), rows.end(), expected.begin(), expected.end());
}

// Kruskal on all pairs, ties by the lower nodes.
std::vector<std::pair<NodeId, NodeId>> by_all_pairs(const std::vector<Vec3>& x) {
  std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> all;
  for (std::uint32_t i = 0; i < x.size(); ++i)
    for (std::uint32_t j = i + 1; j < x.size(); ++j) all.push_back({squared_distance(x[i], x[j]), i, j});
  std::sort(all.begin(), all.end());
  std::vector<std::uint32_t> of(x.size());
  for (std::uint32_t i = 0; i < x.size(); ++i) of[i] = i;
  std::vector<std::pair<NodeId, NodeId>> tree;
  for (const auto& [square, i, j] : all) {
    const auto from = of[i], to = of[j];
    if (from == to) continue;
    std::replace(of.begin(), of.end(), from, to);
    tree.push_back({NodeId(i), NodeId(j)});
  }
  std::sort(tree.begin(), tree.end());
  return tree;
}

}  // namespace

TEST_CASE("nearest nodes are those of a full scan, in its order, however the nodes lie and on every kind of vectors") {
  const auto [first, count] = seeds(240);
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    Random random(seed);
    const int kind = static_cast<int>(seed % cloud_kinds), k = static_cast<int>(random.below(40));
    const auto x = cloud(random, kind, 1 + static_cast<int>(random.below(random.below(4) ? 300 : 12)));
    CAPTURE(seed, kind, k, x.size());
    const auto expected = by_full_scan(x, k);
    for_each_simd_target([&] { REQUIRE(rows_are(nearest_nodes(x, k), expected)); });
  }
}

TEST_CASE("nearest nodes of large sets are those of a full scan too, for any number of threads") {
  for (int kind = 0; kind < cloud_kinds; ++kind) {
    Random random(static_cast<std::uint64_t>(kind) + 1);
    const auto x = cloud(random, kind, 2500);
    CAPTURE(kind);
    const auto expected = by_full_scan(x, 26);
    for (const int threads : {1, 2, 4}) {
      set_threads(threads);
      CHECK(rows_are(nearest_nodes(x, 26), expected));
    }
    set_threads(0);
  }
}

TEST_CASE("the spanning tree is the one of all pairs, ties and all, and says what nearest nodes lack of it") {
  const auto [first, count] = seeds(240);
  std::size_t beyond_found = 0;
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    Random random(seed);
    const int kind = static_cast<int>(seed % cloud_kinds), k = static_cast<int>(random.below(12));
    const auto x = cloud(random, kind, 1 + static_cast<int>(random.below(random.below(4) ? 150 : 12)));
    CAPTURE(seed, kind, k, x.size());
    auto expected = by_all_pairs(x);
    REQUIRE((spanning_tree(x) == expected));
    const NodeTree tree(x);
    const auto near = nearest_nodes(tree, k);
    const auto has = [&](NodeId i, NodeId j) {
      const auto row = near.begin() + static_cast<std::ptrdiff_t>(i.index()) * k;
      return std::find(row, row + k, j) != row + k;
    };
    std::erase_if(expected, [&](const auto& e) { return has(e.first, e.second) || has(e.second, e.first); });
    REQUIRE((spanning_tree_beyond(tree, x, near, k) == expected));
    beyond_found += expected.size();
  }
  CHECK(beyond_found > 0);
}

TEST_CASE("the tree over nodes is the same for any number of threads, and holds every node once") {
  for (int kind = 0; kind < cloud_kinds; ++kind) {
    Random random(static_cast<std::uint64_t>(kind) + 1);
    const auto x = cloud(random, kind, 50000);  // several tasks' worth
    CAPTURE(kind);
    set_threads(1);
    const NodeTree one(x);
    for (const int threads : {2, 4}) {
      set_threads(threads);
      const NodeTree tree(x);
      REQUIRE(std::ranges::equal(tree.nodes(), one.nodes()));
      REQUIRE(std::ranges::equal(tree.cells(), one.cells(), [](const auto& a, const auto& b) {
        return a.begin == b.begin && a.end == b.end && a.parent == b.parent && a.children == b.children &&
               std::equal(a.lo, a.lo + 3, b.lo) && std::equal(a.hi, a.hi + 3, b.hi);
      }));
    }
    set_threads(0);
    std::vector<std::uint32_t> nodes(one.nodes().begin(), one.nodes().end());
    std::sort(nodes.begin(), nodes.end());
    bool once = true, parted = true, tight = true;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) once = once && nodes[i] == i;
    for (std::uint32_t c = 0; c < one.cells().size(); ++c) {
      const auto& cell = one.cells()[c];
      Box3 box;
      for (auto slot = cell.begin; slot < cell.end; ++slot) box.add(x[one.nodes()[slot]]);
      for (int axis = 0; axis < 3; ++axis)
        tight = tight && box.lo[axis] == cell.lo[axis] && box.hi[axis] == cell.hi[axis];
      if (cell.leaf()) continue;
      const auto &l = one.cells()[cell.children], &r = one.cells()[cell.children + 1];
      parted = parted && cell.children > c && l.parent == c && r.parent == c && l.begin == cell.begin &&
               l.end == r.begin && r.end == cell.end;
    }
    CHECK(nodes.size() == x.size());
    CHECK(once);
    CHECK(parted);
    CHECK(tight);
  }
}
