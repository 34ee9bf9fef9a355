// Guides: distances around concave edges (§ 8).
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>

#include "cases.h"
#include "concave_shapes.h"
#include "graph/build_graph.h"
#include "graph/guide_edges.h"
#include "graph/guide_placement.h"
#include "kerf/error.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "node_cases.h"
#include "simd_targets.h"

using namespace geo;

namespace {

VisibilityGraph guided(const NodeSet& nodes, const TriangleBvh& tree, const std::vector<Guide>& guides,
                       NeighborMethod method = NeighborMethod::automatic) {
  VisibilityGraph graph = build_visibility_graph(nodes, tree, 26);
  add_guides(nodes, NodeGrid(0.125, nodes.position), tree, guides, graph);
  build_neighborhoods(nodes, graph, tree, method);
  return graph;
}

std::function<bool(const Vec3&, const Vec3&)> sight_in(const TriangleBvh& tree) {
  return [&tree](const Vec3& p, const Vec3& q) { return tree.blocks(p, q); };
}

}  // namespace

TEST_CASE("every method, vector width and number of threads gives the same rows with guides") {
  std::size_t shortened = 0, gained = 0;
  for (int seed = 1; seed <= cases(10); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const NodeSet nodes = jittered(random, 6 + seed % 3, seed % 4 == 0 ? 0 : 0.4, seed % 3 == 0 ? 3 : 1);
    const Soup faces = random_faces(random, 2 + static_cast<int>(random.below(12)));
    const TriangleBvh tree(faces);
    const auto guides = random_guides(random, 40, faces);
    const auto rows = guided(nodes, tree, guides), bare = guided(nodes, tree, {});
    REQUIRE(rows == guided(nodes, tree, guides, NeighborMethod::dijkstra));
    REQUIRE(rows == guided(nodes, tree, guides, NeighborMethod::mfw));
    VisibilityGraph again = rows;
    build_neighborhoods(nodes, again, tree);
    REQUIRE(rows == again);
    for_each_simd_target([&] { REQUIRE(rows == guided(nodes, tree, guides)); });
    set_threads(seed % 2 ? 1 : 4);
    REQUIRE(rows == guided(nodes, tree, guides));
    set_threads(0);

    // Guides are no neighbours, and remove none.
    REQUIRE(rows.edge_count() == bare.edge_count());
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      std::vector<std::uint32_t> edges, bare_edges;
      for (const NodeId j : rows.edges(NodeId(i))) edges.push_back(j.value);
      for (const NodeId j : bare.edges(NodeId(i))) bare_edges.push_back(j.value);
      REQUIRE(edges == bare_edges);
      std::vector<Neighbor> with, without;
      for (const auto& n : rows.neighbors(nodes, NodeId(i))) with.push_back(n);
      for (const auto& n : bare.neighbors(nodes, NodeId(i))) without.push_back(n);
      REQUIRE(rows.neighbor_count(NodeId(i)) == with.size());
      auto at = with.begin();
      for (const auto& n : without) {
        at = std::find_if(at, with.end(), [&](const Neighbor& m) { return m.to == n.to; });
        REQUIRE(at != with.end());
        REQUIRE(at->to.index() < nodes.size());
        REQUIRE(at->warped <= n.warped);
        shortened += at->distance < n.distance;
      }
      gained += with.size() - without.size();
    }
    std::vector<std::uint32_t> component, bare_component;
    CHECK(rows.components(component) == bare.components(bare_component));
    CHECK(component == bare_component);
  }
  CHECK(shortened > 500);
  CHECK(gained > 500);
}

TEST_CASE("guides stand beside concave edges, inside, and nowhere else") {
  for (const auto& prism : concave_prisms()) {
    CAPTURE(prism.name);
    const auto mesh = walls_of(prism);
    const TriangleBvh tree(corners_of(mesh));
    const NodeSet nodes = nodes_in(prism, 8, 3);
    const NodeGrid grid(0.125, nodes.position);
    const auto blocked = sight_in(tree);
    const auto guides = place_guides(edges_of(mesh), nodes, grid, blocked);
    CHECK(guides.size() == 16 * prism.concave.size());
    const PrismPaths paths(prism);
    for (const auto& g : guides) {
      CHECK(paths.inside({g.position.x(), g.position.y()}, 1e-6));
      double nearest = 1;
      for (const auto c : prism.concave)
        nearest =
            std::min(nearest, std::hypot(g.position.x() - prism.polygon[c][0], g.position.y() - prism.polygon[c][1]));
      CHECK(nearest < 0.125 / 60);
    }
    CHECK(place_guides(edges_of(mesh), nodes, grid, blocked, {1.0, 20}).size() == 8 * prism.concave.size());
    // None where there are some already.
    GuideSet taken;
    for (const auto& g : guides) taken.add(g);
    CHECK(place_guides(edges_of(mesh), nodes, grid, blocked, {}, taken).empty());
    CHECK_THROWS_AS(place_guides(edges_of(mesh), nodes, grid, blocked, {0, 20}), InputError);
    CHECK_THROWS_AS(place_guides(edges_of(mesh), nodes, grid, blocked, {0.5, 0.0 / 0.0}), InputError);
  }
  // An edge that turns by 90 degrees is left out when the option exceeds that; a crack's front
  // never is.
  const auto prisms = concave_prisms();
  for (const std::size_t p : {0, 3}) {
    const auto mesh = walls_of(prisms[p]);
    const TriangleBvh tree(corners_of(mesh));
    const NodeSet nodes = nodes_in(prisms[p], 8, 3);
    CHECK(place_guides(edges_of(mesh), nodes, NodeGrid(0.125, nodes.position), sight_in(tree), {0.5, 100}).empty() ==
          (p == 0));
  }
}

TEST_CASE("with guides, distances of nodes that do not see each other are near the shortest paths") {
  std::size_t pairs = 0;
  for (const auto& prism : concave_prisms())
    for (int seed = 1; seed <= cases(2); ++seed) {
      CAPTURE(prism.name, seed);
      const auto mesh = walls_of(prism);
      const TriangleBvh tree(corners_of(mesh));
      const NodeSet nodes = nodes_in(prism, 10, static_cast<std::uint64_t>(seed));
      // With supports of twice the size rows tell distances of those, too, that ought to be
      // neighbours and are not.
      NodeSet wide = nodes;
      for (double& r : wide.radius) r *= 2;
      const auto bare = guided(wide, tree, {}),
                 with = guided(wide, tree,
                               place_guides(edges_of(mesh), nodes, NodeGrid(0.1, nodes.position), sight_in(tree)));
      const PrismPaths paths(prism);
      ConcaveErrors errors, errors_with;
      for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const auto add = [&](const VisibilityGraph& graph, ConcaveErrors& to) {
          for (const auto& n : graph.neighbors(wide, NodeId(i))) {
            const double exact = paths.length(nodes.position[i], nodes.position[n.to.index()]);
            if (exact < nodes.radius[i] && tree.blocks(nodes.position[i], nodes.position[n.to.index()]))
              to.add(n.distance, exact, nodes.radius[i]);
          }
        };
        add(bare, errors);
        add(with, errors_with);
      }
      CAPTURE(errors.count, errors_with.count, errors.mean(), errors_with.mean(), errors.worst, errors_with.worst,
              errors.missed, errors_with.missed);
      REQUIRE(errors.count > 0);
      pairs += errors.count;
      CHECK(errors_with.count >= errors.count);
      CHECK(errors_with.least > -1e-6);  // no path is shorter than the shortest
      CHECK(errors_with.mean() < 0.5 * errors.mean());
      CHECK(errors_with.worst < 0.5 * errors.worst);
      CHECK(2 * errors_with.missed < errors.missed);
    }
  CHECK(pairs > 1000);
}
