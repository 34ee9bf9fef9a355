// The arena of rows against a plain map.
#include <catch2/catch.hpp>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "graph/adjacency_store.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/error.h"
#include "kerf/graph.h"
#include "node_cases.h"

using namespace geo;

namespace {

struct Row {
  std::vector<std::uint32_t> to;
  std::vector<std::uint16_t> bits;
  std::vector<float> paths;
  AdjacencyRow view() const { return {to, bits, paths}; }
};

Row random_row(Random& random, std::uint32_t most) {
  Row row;
  const auto count = random.below(most + 1);
  for (std::uint32_t k = 0, at = 0; k < count; ++k) {
    row.to.push_back(at += 1 + random.below(9));
    row.bits.push_back(static_cast<std::uint16_t>(random.below(65536)));
    if (AdjacencyRow::has_path(row.bits.back())) row.paths.push_back(static_cast<float>(random.uniform()));
  }
  return row;
}

}  // namespace

TEST_CASE("rows come back as they were put in, however often they grow and shrink") {
  for (int seed = 1; seed <= cases(8); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    AdjacencyStore store;
    std::map<std::size_t, Row> model;
    std::size_t rows = 40, live = 0;
    store.resize(rows);
    for (int step = 0; step < 4000; ++step) {
      if (step % 100 == 0) store.resize(rows += random.below(10));
      const std::size_t i = random.below(static_cast<std::uint32_t>(rows));
      const Row row = random_row(random, seed == 1 && step % 500 == 0 ? 50000 : 120);
      store.set(i, row.view());
      model[i] = row;
      if (step == 2000) {
        const AdjacencyStore copy = store;
        store = AdjacencyStore();
        store = copy;
      }
      const std::size_t j = random.below(static_cast<std::uint32_t>(rows));
      REQUIRE(store.row(j) == model[j].view());
    }
    for (std::size_t i = 0; i < rows; ++i) {
      REQUIRE(store.row(i) == model[i].view());
      live += 10 * model[i].to.size();
    }
    // Memory that rows release is used again.
    CHECK(store.bytes() < 4 * live + (6u << 20));
  }
}

TEST_CASE("a row that is too long is refused") {
  AdjacencyStore store;
  store.resize(1);
  Row row;
  row.to.resize(AdjacencyStore::max_entries + 1);
  row.bits.resize(row.to.size());
  CHECK_THROWS_AS(store.set(0, row.view()), InputError);
}

TEST_CASE("edges added and removed are those of a map") {
  for (int seed = 1; seed <= cases(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const NodeSet nodes = jittered(random, 4, 0.4);
    const auto n = static_cast<std::uint32_t>(nodes.size());
    VisibilityGraph graph = build_visibility_graph(nodes, TriangleBvh(), 8);
    if (seed % 2) build_neighborhoods(nodes, graph, TriangleBvh());
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> model;
    std::size_t edges = graph.edge_count();
    for (std::uint32_t i = 0; i < n; ++i)
      for (const NodeId j : graph.edges(NodeId(i))) model[{i, j.value}] = true;
    for (int step = 0; step < 3000; ++step) {
      const auto i = random.below(n), j = random.below(n);
      if (i == j) continue;
      const bool there = model[{i, j}];
      REQUIRE(graph.has_edge(NodeId(i), NodeId(j)) == there);
      const bool wanted = random.below(2);
      REQUIRE((wanted ? GraphStorage::of(graph).add(nodes, i, j) : GraphStorage::of(graph).remove(i, j)) ==
              (wanted != there));
      edges = edges + (wanted && !there) - (!wanted && there);
      model[{i, j}] = model[{j, i}] = wanted;
      REQUIRE(graph.edge_count() == edges);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      std::vector<NodeId> expected, found;
      for (std::uint32_t j = 0; j < n; ++j)
        if (model[{i, j}]) expected.push_back(NodeId(j));
      for (const NodeId j : graph.edges(NodeId(i))) found.push_back(j);
      REQUIRE(found == expected);
    }
  }
}

TEST_CASE("rows survive a trip through flat arrays, and damaged arrays are refused") {
  Random random(4);
  const NodeSet nodes = jittered(random, 6, 0.4);
  const TriangleBvh tree(random_faces(random, 8));
  VisibilityGraph graph = build_visibility_graph(nodes, tree, 26);
  build_neighborhoods(nodes, graph, tree);
  std::vector<std::uint32_t> counts;
  Row flat;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const AdjacencyRow row = graph.row(NodeId(i));
    flat.to.insert(flat.to.end(), row.to.begin(), row.to.end());
    flat.bits.insert(flat.bits.end(), row.bits.begin(), row.bits.end());
    flat.paths.insert(flat.paths.end(), row.paths.begin(), row.paths.end());
    counts.push_back(static_cast<std::uint32_t>(row.to.size()));
  }
  const auto read = [&] {
    return GraphStorage::from_arrays(nodes, GraphStorage::of(graph).plain_unit(),
                                     {counts, flat.to, flat.bits, flat.paths});
  };
  const auto again = read();
  CHECK(again.equals(GraphStorage::of(graph)));
  CHECK(again.edge_count() == graph.edge_count());
  CHECK(again.longest_edge() == GraphStorage::of(graph).longest_edge());
  for (int damage = 0; damage < 500; ++damage) {
    CAPTURE(damage);
    const Row kept = flat;
    const auto kept_counts = counts;
    const auto e = random.below(static_cast<std::uint32_t>(flat.to.size()));
    const auto i = random.below(static_cast<std::uint32_t>(counts.size()));
    switch (damage % 5) {
      case 0:
        flat.to[e] ^= 1u << random.below(32);
        break;
      case 1:
        flat.bits[e] ^= static_cast<std::uint16_t>(1u << random.below(16));
        break;
      case 2:
        counts[i] += random.below(2) ? 1 : ~0u;
        break;
      case 3:
        flat.paths[random.below(static_cast<std::uint32_t>(flat.paths.size()))] = -1;
        break;
      default:
        flat.paths.pop_back();
    }
    REQUIRE_THROWS_AS(read(), InputError);
    flat = kept;
    counts = kept_counts;
  }
}
