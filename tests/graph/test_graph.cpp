#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "cases.h"
#include "geometry/predicates.h"
#include "graph/update.h"
#include "sampling/sample.h"
#include "surface/shapes.h"

using namespace geo;

namespace {

NodeSet jittered(Random& random, int n, double jitter) {
  NodeSet nodes;
  const double h = 1.0 / n;
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 p = h * (Vec3(i % n, i / n % n, i / n / n) + Vec3::Constant(0.5));
    nodes.position.push_back(p + jitter * h * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    nodes.radius.push_back(h * (1.8 + 0.4 * p.x()));
    nodes.spacing.push_back(h);
    nodes.volume.push_back(h * h * h);
  }
  return nodes;
}

using Soup = std::vector<std::array<Vec3, 3>>;

}  // namespace

TEST_CASE("edges are those that no triangle touches and every method and thread count gives the same rows") {
  Random random(7);
  const NodeSet nodes = jittered(random, 8, 0.3);
  const Soup wall{{Vec3(0.513, -1, -1), Vec3(0.521, 0.6, -1), Vec3(0.507, -1, 2)}, {Vec3(0.521, 0.6, -1), Vec3(0.52, 0.61, 2), Vec3(0.507, -1, 2)}};
  const TriangleBvh tree(wall);
  const auto graph = build_visibility_graph(nodes, tree, 26);
  const auto open = build_visibility_graph(nodes, TriangleBvh(), 26);
  CHECK(graph.edge_count() < open.edge_count());
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const auto& arc : open.arcs(NodeId(i))) {
      const bool blocked = segment_meets_triangle(nodes.position[i], nodes.position[arc.to.index()], wall[0][0], wall[0][1], wall[0][2]) ||
                           segment_meets_triangle(nodes.position[i], nodes.position[arc.to.index()], wall[1][0], wall[1][1], wall[1][2]);
      REQUIRE(graph.has(NodeId(i), arc.to) == !blocked);
    }
  const auto rows = build_neighborhoods(nodes, graph, tree);
  CHECK(rows == build_neighborhoods(nodes, graph, tree, NeighborMethod::dijkstra));
  CHECK(rows == build_neighborhoods(nodes, graph, tree, NeighborMethod::mfw));
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const auto& n : rows.of(NodeId(i))) {
      const auto& back = rows.of(n.to);
      const auto it = std::find_if(back.begin(), back.end(), [&](const Neighbor& b) { return b.to == NodeId(i); });
      REQUIRE(it != back.end());
      REQUIRE(it->warped == n.warped);
      REQUIRE(it->distance == n.distance);
    }
  for (const int count : {1, 4}) {
    set_threads(count);
    CHECK(rows == build_neighborhoods(nodes, build_visibility_graph(nodes, tree, 26), tree));
  }
  set_threads(0);
}

TEST_CASE("incremental updates equal a build from scratch, bit for bit") {
  std::size_t rows_compared = 0;
  for (int seed = 1; seed <= cases(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    NodeSet nodes = jittered(random, 8, 0.35);
    Soup all;
    VisibilityGraph graph = build_visibility_graph(nodes, TriangleBvh(), 26);
    Neighborhoods rows = build_neighborhoods(nodes, graph, TriangleBvh());
    NodeGrid grid(0.125, nodes.position);
    const Vec3 n = random.direction(), a = n.cross(random.direction()).normalized(), b = n.cross(a);
    const auto at = [&](double u, double v) { return Vec3(Vec3::Constant(0.5) + (u - 0.6) * a * 1.6 + (v - 0.5) * b * 1.8 + 0.05 * std::sin(5 * u + 3 * v) * n + 0.003 * n); };
    for (int step = 0; step < 8; ++step) {
      Soup fresh;
      for (int j = 0; j < 6; ++j) {
        const double u0 = step / 8.0, u1 = (step + 1) / 8.0, v0 = j / 6.0, v1 = (j + 1) / 6.0;
        fresh.push_back({at(u0, v0), at(u1, v0), at(u1, v1)});
        fresh.push_back({at(u0, v0), at(u1, v1), at(u0, v1)});
      }
      all.insert(all.end(), fresh.begin(), fresh.end());
      const TriangleBvh tree(all);
      const NodeId first(nodes.size());
      if (seed % 2 == 0)
        for (int i = 0; i < 3; ++i) {
          const Vec3 p(random.uniform(0.1, 0.9), random.uniform(0.1, 0.9), random.uniform(0.1, 0.9));
          nodes.position.push_back(p), nodes.radius.push_back(0.22), nodes.spacing.push_back(0.1), nodes.volume.push_back(1e-4);
          grid.insert(nodes.position, static_cast<std::uint32_t>(nodes.size() - 1));
        }
      const auto near = [&](const Box3& box, Soup& out) {
        for (const auto& t : all)
          if (box_of(t[0], t[1], t[2]).meets(box)) out.push_back(t);
      };
      const auto result = update_graph(nodes, first, {}, fresh, near, 26, grid, graph, rows);
      for (std::uint32_t i = 0; i < nodes.size(); ++i)
        for (const auto& arc : graph.arcs(NodeId(i))) REQUIRE_FALSE(tree.blocks(nodes.position[i], nodes.position[arc.to.index()]));
      for (const auto& [i, j] : result.cut_edges) REQUIRE(tree.blocks(nodes.position[i.index()], nodes.position[j.index()]));
      const auto scratch = build_neighborhoods(nodes, graph, tree);
      for (std::size_t i = 0; i < nodes.size(); ++i, ++rows_compared) REQUIRE(rows.rows[i] == scratch.rows[i]);
    }
  }
  CHECK(rows_compared > 20000);
}

TEST_CASE("a segment through the seam of two triangles is blocked") {
  const Soup roof{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0.5)}, {Vec3(1, 0, 0), Vec3(1, 1, 0.5), Vec3(0, 1, 0.5)}};
  const TriangleBvh tree(roof);
  CHECK(tree.blocks({0.5, 0.5, -1}, {0.5, 0.5, 2}));   // the shared edge
  CHECK(tree.blocks({1, 0, -1}, {1, 0, 1}));           // a shared corner
}

TEST_CASE("samples are inside, graded, and own the whole volume") {
  const TriangleMesh mesh = make_pumpkin(8);
  SampleOptions options;
  options.spacing = 0.12;
  const NodeSet nodes = sample_nodes(mesh, options);
  Soup soup;
  for (const auto& [a, b, c] : mesh.triangles) soup.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  const TriangleBvh tree(soup);
  for (const auto& p : nodes.position) REQUIRE(tree.inside(p));
  CHECK(std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0) == Approx(signed_volume(mesh)).epsilon(1e-12));
  CHECK(*std::max_element(nodes.spacing.begin(), nodes.spacing.end()) == Approx(2 * *std::min_element(nodes.spacing.begin(), nodes.spacing.end())));
  set_threads(1);
  const NodeSet again = sample_nodes(mesh, options);
  set_threads(0);
  CHECK(again.position == nodes.position);
  SampleOptions counted;
  counted.count = 900;
  CHECK(std::abs(double(sample_nodes(mesh, counted).size()) - 900) < 45);
}
