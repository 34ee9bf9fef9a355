#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "graph/build_graph.h"
#include "kerf/graph.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/parallel.h"
#include "node_cases.h"

using namespace geo;

TEST_CASE("edges are those that no triangle touches") {
  Random random(7);
  const NodeSet nodes = jittered(random, 8, 0.3);
  const Soup wall{{Vec3(0.513, -1, -1), Vec3(0.521, 0.6, -1), Vec3(0.507, -1, 2)},
                  {Vec3(0.521, 0.6, -1), Vec3(0.52, 0.61, 2), Vec3(0.507, -1, 2)}};
  const TriangleBvh tree(wall);
  const auto graph = build_visibility_graph(nodes, tree, 26);
  const auto open = build_visibility_graph(nodes, TriangleBvh(), 26);
  CHECK(graph.edge_count() < open.edge_count());
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const NodeId j : open.edges(NodeId(i))) {
      const bool blocked =
          segment_meets_triangle(nodes.position[i], nodes.position[j.index()], wall[0][0], wall[0][1], wall[0][2]) ||
          segment_meets_triangle(nodes.position[i], nodes.position[j.index()], wall[1][0], wall[1][1], wall[1][2]);
      REQUIRE(graph.has_edge(NodeId(i), j) == !blocked);
    }
  CHECK(graph == build_visibility_graph(nodes, tree, 26));
}

TEST_CASE("a segment through the seam of two triangles is blocked") {
  const Soup roof{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0.5)}, {Vec3(1, 0, 0), Vec3(1, 1, 0.5), Vec3(0, 1, 0.5)}};
  const TriangleBvh tree(roof);
  CHECK(tree.blocks({0.5, 0.5, -1}, {0.5, 0.5, 2}));  // the shared edge
  CHECK(tree.blocks({1, 0, -1}, {1, 0, 1}));          // a shared corner
}

TEST_CASE("samples are inside, graded, and own the whole volume") {
  const TriangleMesh mesh = make_pumpkin(8);
  SampleOptions options;
  options.spacing = 0.12;
  const NodeSet nodes = sample_nodes(mesh, options);
  const TriangleBvh tree(corners_of(mesh));
  for (const auto& p : nodes.position) REQUIRE(tree.inside(p));
  CHECK(std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0) == Approx(signed_volume(mesh)).epsilon(1e-12));
  CHECK(*std::max_element(nodes.spacing.begin(), nodes.spacing.end()) ==
        Approx(2 * *std::min_element(nodes.spacing.begin(), nodes.spacing.end())));
  set_threads(1);
  const NodeSet again = sample_nodes(mesh, options);
  set_threads(0);
  CHECK(again.position == nodes.position);
  SampleOptions counted;
  counted.count = 900;
  CHECK(std::abs(double(sample_nodes(mesh, counted).size()) - 900) < 45);
}
