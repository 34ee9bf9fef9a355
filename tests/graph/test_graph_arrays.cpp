// The graph as arrays, and small parts of the graph module on their own.
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "graph/block_release.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/guide_set.h"
#include "graph/id_set.h"
#include "graph/lengths.h"
#include "graph/node_cases.h"
#include "kerf/graph.h"

using namespace geo;

namespace {

// Four nodes on a line, 1 apart, and a wall between the second and the third.
NodeSet line_of_nodes() {
  NodeSet nodes;
  for (int i = 0; i < 4; ++i) {
    nodes.position.push_back(Vec3(i, 0, 0));
    nodes.radius.push_back(1.5);
    nodes.spacing.push_back(1);
    nodes.volume.push_back(1);
  }
  return nodes;
}

const std::array<Vec3, 3> wall{Vec3(1.5, -9, -9), Vec3(1.5, 9, -9), Vec3(1.5, 0, 9)};

}  // namespace

TEST_CASE("edges and neighbours as CSR arrays, by hand", "[arrays]") {
  const NodeSet nodes = line_of_nodes();
  VisibilityGraph graph = build_visibility_graph(nodes, std::vector{wall}, 3);
  build_neighborhoods(nodes, graph, std::vector{wall});
  const CsrArrays edges = edge_arrays(nodes, graph), neighbors = neighbor_arrays(nodes, graph);
  REQUIRE(edges.indptr == std::vector<std::uint64_t>{0, 1, 2, 3, 4});
  REQUIRE(edges.indices == std::vector<std::uint32_t>{1, 0, 3, 2});
  REQUIRE(edges.distances == std::vector<float>{1, 1, 1, 1});
  REQUIRE(neighbors.indptr == edges.indptr);
  REQUIRE(neighbors.indices == edges.indices);
  REQUIRE(neighbors.distances == edges.distances);
  // Without the wall, nodes 2 apart are farther than a support radius along the graph, though
  // joined.
  VisibilityGraph open = build_visibility_graph(nodes, std::span<const std::array<Vec3, 3>>(), 3);
  build_neighborhoods(nodes, open, std::span<const std::array<Vec3, 3>>());
  REQUIRE(edge_arrays(nodes, open).indices == std::vector<std::uint32_t>{1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2});
  REQUIRE(edge_arrays(nodes, open).distances[2] == 3);
  REQUIRE(neighbor_arrays(nodes, open).indices == std::vector<std::uint32_t>{1, 0, 2, 1, 3, 2});
  REQUIRE(edge_arrays({}, VisibilityGraph()).indptr == std::vector<std::uint64_t>{0});
}

TEST_CASE("CSR arrays are symmetric and equal to the ranges", "[arrays]") {
  for (int seed = 1; seed <= cases(4); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const NodeSet nodes = jittered(random, 5, 0.4);
    const auto faces = random_faces(random, 6);
    VisibilityGraph graph = build_visibility_graph(nodes, faces, 20);
    build_neighborhoods(nodes, graph, faces);
    const CsrArrays arrays = neighbor_arrays(nodes, graph);
    REQUIRE(arrays.indptr.size() == nodes.size() + 1);
    REQUIRE(arrays.indptr.back() == arrays.indices.size());
    REQUIRE(arrays.distances.size() == arrays.indices.size());
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> distance;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      for (auto e = arrays.indptr[i]; e < arrays.indptr[i + 1]; ++e)
        distance[{i, arrays.indices[e]}] = arrays.distances[e];
    REQUIRE(distance.size() == arrays.indices.size());
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      for (const Neighbor& n : graph.neighbors(nodes, NodeId(i))) {
        ++count;
        REQUIRE(distance.at({i, n.to.value}) == n.distance);
        REQUIRE(distance.at({n.to.value, i}) == n.distance);
        const double straight = (nodes.position[i] - nodes.position[n.to.index()]).norm();
        REQUIRE(n.distance >= float(straight) * (1 - 1e-6f));
        if (!n.hidden) REQUIRE(n.distance == Approx(straight));
      }
    REQUIRE(count == distance.size());
  }
}

TEST_CASE("warped and plain lengths are rounded up and bounded", "[lengths]") {
  const Vec3 origin(0, 0, 0);
  CHECK(warped_length(origin, Vec3(1, 0, 0), 1, 2) == unit_radius / 2);
  CHECK(warped_length(origin, Vec3(3, 4, 0), 10, 1) == unit_radius / 2);
  CHECK(warped_length(origin, origin, 1, 1) == 1);
  CHECK(warped_length(origin, Vec3(1e9, 0, 0), 1, 1) == longest_length);
  CHECK(warped_length(origin, Vec3(1, 0, 0), 3, 3) == (unit_radius + 2) / 3);  // 2²⁴ = 1 mod 3
  CHECK(plain_length(origin, Vec3(0, 0, 2.25), 0.5) == 5);
  NodeSet nodes = line_of_nodes();
  CHECK(plain_unit_for(nodes) == 0x1p-25);
  nodes.radius.assign(4, 1.0);
  CHECK(plain_unit_for(nodes) == 0x1p-26);
}

TEST_CASE("a set of guides finds those within a distance, retired ones too", "[guides]") {
  for (int seed = 1; seed <= cases(4); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    GuideSet guides;
    double largest = 0;
    for (int g = 0; g < 60; ++g) {
      guides.add({Vec3(random.uniform(), random.uniform(), random.uniform()), random.uniform(0.05, 0.4)});
      largest = std::max(largest, guides.radius(static_cast<std::uint32_t>(g)));
    }
    REQUIRE(guides.size() == 60);
    REQUIRE(guides.largest_radius() == largest);
    guides.retire(7);
    REQUIRE((guides.retired(7) && !guides.retired(8)));
    for (int query = 0; query < 50; ++query) {
      const Vec3 p(random.uniform(), random.uniform(), random.uniform());
      const double distance = random.uniform(0, 0.5);
      std::vector<std::uint32_t> found, expected;
      guides.within(p, distance, found);
      for (std::uint32_t g = 0; g < guides.size(); ++g)
        if ((guides.position(g) - p).squaredNorm() <= distance * distance) expected.push_back(g);
      REQUIRE(found == expected);
    }
  }
}

TEST_CASE("an id set is a set, also after it was cleared", "[ids]") {
  Random random(5);
  IdSet ids;
  for (int round = 0; round < 20; ++round) {
    ids.clear();
    std::set<std::uint32_t> expected;
    std::vector<std::uint32_t> order;
    for (int i = 0; i < 200; ++i) {
      const auto id = random.below(300) + (random.below(2) ? VisibilityGraph::first_guide : 0);
      if (expected.insert(id).second) order.push_back(id);
      ids.add(id);
    }
    REQUIRE(ids.ids() == order);
    for (std::uint32_t i = 0; i < 400; ++i) {
      REQUIRE(ids.has(i) == (expected.count(i) > 0));
      REQUIRE(ids.has(GraphStorage::guide_id(i)) == (expected.count(GraphStorage::guide_id(i)) > 0));
    }
  }
}

TEST_CASE("blocks of rows are released once all runs that may read them are done", "[release]") {
  // Nodes on a line, far apart in relation to edges: a run reads its own nodes and the ends of its
  // edges.
  const std::uint32_t n = 4000;
  const std::size_t run = 100;
  NodeSet nodes;
  for (std::uint32_t i = 0; i < n; ++i) {
    nodes.position.push_back(Vec3(i, 0, 0));
    nodes.radius.push_back(1.5);
    nodes.spacing.push_back(1);
    nodes.volume.push_back(1);
  }
  VisibilityGraph graph = build_visibility_graph(nodes, TriangleBvh(), 2);
  GraphStorage& storage = GraphStorage::of(graph);
  AdjacencyStore to;
  to.resize(n);
  BlockRelease release(nodes, storage, run, to);
  std::size_t done = 0;
  for (std::size_t c = 0; c < n / run; ++c) {
    if (c + 1 < n / run) REQUIRE(!storage.entries(n - 1).to.empty());  // nothing that is still needed has gone
    release.done(c);
    ++done;
  }
  REQUIRE(done == 40);
  // All blocks have gone over: the store that is filled takes them before it allocates.
  REQUIRE(storage.rows().block_count() >= 1);
  to.drop_spare();
  AdjacencyStore::Writer writer(to);
  const std::vector<std::uint32_t> ids{1};
  const std::vector<std::uint16_t> bits{AdjacencyRow::edge_bit};
  writer.set(0, {ids, bits, {}});
  REQUIRE(to.row(0).to[0] == 1);
}
