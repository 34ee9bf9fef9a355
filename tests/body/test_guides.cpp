// Bodies with guides (§ 8): along concave edges of the model and the fronts of its cracks.
#include <catch2/catch.hpp>
#include <map>

#include "body/locate.h"
#include "graph/graph_storage.h"
#include "invariants/cut_bodies.h"
#include "kerf/body.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

Body make_body(const TriangleMesh& mesh, double spacing, double guides) {
  SampleOptions sampling;
  sampling.spacing = spacing;
  BodyOptions options;
  options.guide_spacing = guides;
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), options);
}

std::size_t guides_in_use(const Body& body) {
  std::size_t count = 0;
  for (std::uint32_t g = 0; g < GraphStorage::of(body.graph).guides().size(); ++g)
    count += !GraphStorage::of(body.graph).entries(VisibilityGraph::first_guide + g).to.empty();
  return count;
}

std::size_t neighbors(const Body& body) {
  std::size_t sum = 0;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) sum += body.graph.neighbor_count(NodeId(i));
  return sum;
}

}  // namespace

TEST_CASE("A letter's inner corners get guides, a block none", "[body]") {
  const TriangleMesh letter = make_letter('E', 0.3, 12);
  const Body bare = make_body(letter, 0.05, 0), guided = make_body(letter, 0.05, 0.5);
  CHECK(GraphStorage::of(bare.graph).guides().size() == 0);
  CHECK(guides_in_use(guided) >= 20);
  CHECK(check_body(guided).first_problem == "");
  CHECK(guided.graph.edge_count() == bare.graph.edge_count());
  // Who sees each other is as far as before; others are nearer, some of them neighbours now.
  std::size_t nearer = neighbors(guided) - neighbors(bare);
  for (std::uint32_t i = 0; i < bare.nodes.size(); ++i) {
    std::map<NodeId, float> with;
    for (const auto& n : guided.graph.neighbors(guided.nodes, NodeId(i))) with[n.to] = n.distance;
    for (const auto& n : bare.graph.neighbors(bare.nodes, NodeId(i))) {
      REQUIRE(with.count(n.to) == 1);
      const bool sees = !is_blocked(bare.surface, bare.nodes.position[i], bare.nodes.position[n.to.index()]);
      CHECK((sees ? with[n.to] == n.distance : with[n.to] <= n.distance));
      nearer += with[n.to] < n.distance;
    }
  }
  CHECK(nearer > 0);
  CHECK(GraphStorage::of(make_body(make_block({1, 1, 1}, 0.5), 0.2, 0.5).graph).guides().size() == 0);
  CHECK_THROWS_AS(make_body(letter, 0.05, 0.01), InputError);
  CHECK_THROWS_AS(make_body(letter, 0.05, 0.0 / 0.0), InputError);
}

TEST_CASE("Guides follow the front of a crack", "[body]") {
  Body body = make_body(make_block({1, 1, 1}, 0.25), 0.1, 1);
  Body bare = make_body(make_block({1, 1, 1}, 0.25), 0.1, 0);
  auto front = begin_front(std::vector<Vec3>{{0.473, -0.5, -0.5}, {0.481, 1.5, -0.5}}, false, 1), other = front;
  std::size_t placed = 0;
  for (int s = 1; s <= 5; ++s) {
    const double z = 0.02 + 0.11 * s;
    split(body, front, {{0.473, -0.5, z}, {0.481, 1.5, z}});
    split(bare, other, {{0.473, -0.5, z}, {0.481, 1.5, z}});
    INFO("step " << s);
    CHECK(check_body(body).first_problem == "");
    CHECK(GraphStorage::of(body.graph).guides().size() > placed);
    placed = GraphStorage::of(body.graph).guides().size();
    // They stand along the front, which they see past on both sides, and nowhere else.
    std::size_t used = 0;
    for (std::uint32_t g = 0; g < placed; ++g) {
      const auto row = GraphStorage::of(body.graph).entries(VisibilityGraph::first_guide + g);
      CHECK(GraphStorage::of(body.graph).guides().retired(g) == row.to.empty());
      if (row.to.empty()) continue;
      ++used;
      CHECK(GraphStorage::of(body.graph).guides().position(g).z() > z);
      CHECK(GraphStorage::of(body.graph).guides().position(g).z() < z + 0.01);
      bool left = false, right = false;
      for (const auto j : row.to)
        if (!VisibilityGraph::is_guide(j) && body.nodes.position[j].z() < z - 0.03)
          (body.nodes.position[j].x() < 0.477 ? left : right) = true;
      CHECK((left && right));
    }
    CHECK(used >= 8);
    CHECK(body.nodes.position == bare.nodes.position);
    CHECK(body.graph.edge_count() == bare.graph.edge_count());
    CHECK(neighbors(body) > neighbors(bare));
  }
}

TEST_CASE("Random cuts keep a pumpkin's body and its guides in step", "[body]") {
  const Body model = make_body(make_pumpkin(5), 0.25, 0.5);
  std::size_t placed = 0, retired = 0;
  random_cuts::cut_bodies(
      model, 6, 32452843, [](const Body& body) { CHECK(check_body(body).first_problem == ""); },
      [&](const Body& body) {
        placed += GraphStorage::of(body.graph).guides().size() - GraphStorage::of(model.graph).guides().size();
        for (std::uint32_t g = 0; g < GraphStorage::of(body.graph).guides().size(); ++g)
          retired += GraphStorage::of(body.graph).guides().retired(g);
      });
  CHECK(placed > 100);
  CHECK(retired > 50);
}
