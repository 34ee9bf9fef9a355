// Rows of neighbours: every method, vector width and number of threads gives the same.
#include <algorithm>
#include <catch2/catch.hpp>

#include "cases.h"
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "graph/batched_search.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/neighborhood_search.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "node_cases.h"
#include "simd_targets.h"

using namespace geo;

namespace {

VisibilityGraph with_rows(const NodeSet& nodes, VisibilityGraph graph, const TriangleBvh& tree,
                          NeighborMethod method = NeighborMethod::automatic) {
  build_neighborhoods(nodes, graph, tree, method);
  return graph;
}

}  // namespace

TEST_CASE("every method gives the same rows, with cracks and graded supports") {
  std::size_t hidden = 0, long_edges = 0;
  for (int seed = 1; seed <= cases(12); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const NodeSet nodes = jittered(random, 6 + seed % 3, seed % 4 == 0 ? 0 : 0.4, seed % 3 == 0 ? 3 : 1);
    const TriangleBvh tree(random_faces(random, static_cast<int>(random.below(14))));
    const auto graph = build_visibility_graph(nodes, tree, 10 + static_cast<int>(random.below(30)));
    const auto rows = with_rows(nodes, graph, tree);
    REQUIRE(rows == with_rows(nodes, graph, tree, NeighborMethod::dijkstra));
    REQUIRE(rows == with_rows(nodes, graph, tree, NeighborMethod::mfw));
    REQUIRE(rows == with_rows(nodes, rows, tree));  // rows of an earlier build change nothing
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const auto row = rows.row(NodeId(i));
      for (std::size_t k = 0; k < row.to.size(); ++k) {
        hidden += AdjacencyRow::has_path(row.bits[k]);
        long_edges += !AdjacencyRow::is_neighbor(row.bits[k]);
        REQUIRE(AdjacencyRow::is_edge(row.bits[k]) == graph.has_edge(NodeId(i), NodeId(row.to[k])));
        REQUIRE((AdjacencyRow::is_edge(row.bits[k]) ||
                 AdjacencyRow::has_path(row.bits[k]) ==
                     tree.blocks(nodes.position[std::min(i, row.to[k])], nodes.position[std::max(i, row.to[k])])));
      }
      for (const auto& n : rows.neighbors(nodes, NodeId(i))) {
        bool back = false;
        for (const auto& m : rows.neighbors(nodes, n.to))
          back = back || (m.to == NodeId(i) && m.distance == n.distance && m.warped == n.warped);
        REQUIRE(back);
        REQUIRE(double(n.distance) >= (nodes.position[i] - nodes.position[n.to.index()]).norm() * (1 - 1e-6));
      }
    }
  }
  CHECK(hidden > 1000);
  CHECK(long_edges > 1000);
}

TEST_CASE("every vector width and number of threads gives the same rows") {
  Random random(5);
  const NodeSet nodes = jittered(random, 14, 0.4, 1.7);
  const TriangleBvh tree(random_faces(random, 12));
  const auto graph = build_visibility_graph(nodes, tree, 26);
  const auto rows = with_rows(nodes, graph, tree);
  std::size_t targets = 0;
  for_each_simd_target([&](const std::string& target) {
    CAPTURE(target);
    ++targets;
    CHECK(rows == with_rows(nodes, graph, tree));
    // Lengths alone, extremes among them.
    for (int n = 0; n < 40; ++n) {
      std::vector<double> squared, radius;
      std::vector<std::uint32_t> lengths(static_cast<std::size_t>(n) + 8);
      for (int k = 0; k < n; ++k) {
        squared.push_back(k % 7 == 0 ? 0 : std::exp(random.uniform(-40, 40)));
        radius.push_back(std::exp(random.uniform(-3, 3)));
      }
      auto padded_squared = squared, padded_radius = radius;
      padded_squared.resize(lengths.size(), 1);
      padded_radius.resize(lengths.size(), 1);
      warped_lengths(padded_squared.data(), padded_radius.data(), squared.size(), lengths.data());
      for (std::size_t k = 0; k < squared.size(); ++k)
        REQUIRE(lengths[k] == warped_length(Vec3(std::sqrt(squared[k]), 0, 0), Vec3(0, 0, 0), radius[k], 0));
    }
  });
  CHECK(targets > 0);
  for (const int count : {1, 2, 4}) {
    set_threads(count);
    CHECK(rows == with_rows(nodes, build_visibility_graph(nodes, tree, 26), tree));
  }
  set_threads(0);
}

TEST_CASE("a search from scattered nodes finds their rows of a build") {
  for (int seed = 1; seed <= cases(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const NodeSet nodes = jittered(random, 9, 0.4, 2);
    const auto rows = with_rows(nodes, build_visibility_graph(nodes, TriangleBvh(), 26), TriangleBvh());
    std::vector<std::uint32_t> sources;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      if (random.uniform() < std::exp(random.uniform(-6, 0))) sources.push_back(i);
    NeighborhoodSearch search;
    std::size_t next = 0;
    search.run(nodes, GraphStorage::of(rows), sources, {}, [&](std::uint32_t i, const AdjacencyRow& row) {
      REQUIRE(i == sources[next++]);
      REQUIRE(row == rows.row(NodeId(i)));
    });
    CHECK(next == sources.size());
  }
}

TEST_CASE("nodes at one place, in one line and alone have rows") {
  NodeSet nodes;
  for (int i = 0; i < 60; ++i)
    nodes.position.push_back(i < 20 ? Vec3(0.5, 0.5, 0.5) : i < 59 ? Vec3(0.01 * i, 0, 0) : Vec3(90, 0, 0));
  nodes.radius.assign(60, 0.2);
  nodes.spacing.assign(60, 0.1);
  nodes.volume.assign(60, 1e-3);
  const auto graph = build_visibility_graph(nodes, TriangleBvh(), 5);
  const auto rows = with_rows(nodes, graph, TriangleBvh());
  CHECK(rows == with_rows(nodes, graph, TriangleBvh(), NeighborMethod::dijkstra));
  CHECK(rows == with_rows(nodes, graph, TriangleBvh(), NeighborMethod::mfw));
  CHECK(rows.neighbor_count(NodeId(59u)) == 0);
  CHECK(rows.neighbor_count(NodeId(3u)) == 19);
  std::vector<std::uint32_t> component;
  CHECK(rows.components(component) == 1);  // the tree's long edges are kept
}
