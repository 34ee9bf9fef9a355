// Updates of graph and rows equal a build from scratch.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "cases.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/guide_edges.h"
#include "graph/update.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "node_cases.h"

using namespace geo;

namespace {

struct Cut {
  NodeSet nodes;
  VisibilityGraph graph;
  NodeGrid grid;
  Soup all;
  int k = 26;

  Cut(NodeSet set, const Soup& walls, int nearest, const std::vector<Guide>& guides = {})
      : nodes(std::move(set)), grid(0.125, nodes.position), all(walls), k(nearest) {
    const TriangleBvh tree(all);
    graph = build_visibility_graph(nodes, tree, k);
    add_guides(nodes, grid, tree, guides, graph);
    build_neighborhoods(nodes, graph, tree);
  }
  NodeId insert(const Vec3& p, double radius) {
    nodes.position.push_back(p);
    nodes.radius.push_back(radius);
    nodes.spacing.push_back(0.1);
    nodes.volume.push_back(1e-4);
    grid.insert(nodes.position, static_cast<std::uint32_t>(nodes.size() - 1));
    return NodeId(nodes.size() - 1);
  }
  GraphUpdate step(NodeId first, const std::vector<NodeId>& moved, const Soup& fresh,
                   const std::vector<std::pair<NodeId, NodeId>>& joins = {}, const GuideChange& guides = {},
                   const std::vector<NodeId>& resized = {}) {
    all.insert(all.end(), fresh.begin(), fresh.end());
    const auto near = [&](const Box3& box, Soup& out) {
      for (const auto& t : all)
        if (box_of(t[0], t[1], t[2]).meets(box)) out.push_back(t);
    };
    return update_graph({.nodes = nodes,
                         .grid = grid,
                         .first_new = first,
                         .k = k,
                         .triangles_near = near,
                         .new_faces = fresh,
                         .moved = moved,
                         .resized = resized,
                         .joins = joins,
                         .guides = guides},
                        graph);
  }
};

// The same edges, of which nothing else is known yet.
VisibilityGraph edges_alone(const NodeSet& nodes, const VisibilityGraph& graph) {
  VisibilityGraph bare;
  GraphStorage::of(bare).resize(nodes.size());
  GraphStorage::of(bare).set_plain_unit(GraphStorage::of(graph).plain_unit());
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const NodeId j : graph.edges(NodeId(i)))
      if (i < j.value) GraphStorage::of(bare).add(nodes, i, j.value);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_guides;
  for (std::uint32_t g = 0; g < GraphStorage::of(graph).guides().size(); ++g) {
    const auto id = GraphStorage::of(bare).add_guide(
        {GraphStorage::of(graph).guides().position(g), GraphStorage::of(graph).guides().radius(g)});
    if (GraphStorage::of(graph).guides().retired(g)) GraphStorage::of(bare).retire_guide(id);
    for (const auto other : GraphStorage::of(graph).entries(id).to) {
      of_guides.push_back({id, other});
      if (!VisibilityGraph::is_guide(other)) of_guides.push_back({other, id});
    }
  }
  std::sort(of_guides.begin(), of_guides.end());
  GraphStorage::of(bare).append_guide_edges(nodes, of_guides);
  return bare;
}

// Edges that are right, and rows that a build along them finds.
void require_as_from_scratch(const Cut& cut, const GraphUpdate& update, const VisibilityGraph& before,
                             std::size_t& rows_compared) {
  const TriangleBvh tree(cut.all);
  const auto& x = cut.nodes.position;
  std::size_t edges = 0;
  for (std::uint32_t i = 0; i < cut.nodes.size(); ++i)
    for (const NodeId j : cut.graph.edges(NodeId(i))) {
      ++edges;
      REQUIRE_FALSE(tree.blocks(x[i], x[j.index()]));
    }
  REQUIRE(cut.graph.edge_count() == edges / 2);
  // Guides see what they see within their reach, no more and no less.
  for (std::uint32_t g = 0; g < GraphStorage::of(cut.graph).guides().size(); ++g) {
    const auto& guides = GraphStorage::of(cut.graph).guides();
    const Vec3& p = guides.position(g);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < cut.nodes.size(); ++i)
      if (!guides.retired(g) && squared_distance(p, x[i]) <= guides.radius(g) * guides.radius(g) &&
          !tree.blocks(x[i], p))
        expected.push_back(i);
    for (std::uint32_t h = 0; h < guides.size(); ++h)
      if (const double r = std::max(guides.radius(g), guides.radius(h));
          h != g && !guides.retired(g) && !guides.retired(h) && squared_distance(p, guides.position(h)) <= r * r &&
          !tree.blocks(guides.position(h), p))
        expected.push_back(VisibilityGraph::first_guide + h);
    const auto row = GraphStorage::of(cut.graph).entries(VisibilityGraph::first_guide + g);
    CAPTURE(g);
    REQUIRE(std::vector<std::uint32_t>(row.to.begin(), row.to.end()) == expected);
    for (std::size_t e = 0; e < row.to.size(); ++e) {
      REQUIRE(cut.graph.has_edge(NodeId(row.to[e]), NodeId(VisibilityGraph::first_guide + g)));
      REQUIRE((AdjacencyRow::is_edge(row.bits[e]) && !AdjacencyRow::is_neighbor(row.bits[e])));
    }
  }
  REQUIRE(cut.graph.edge_count() == before.edge_count() - update.cut_edges.size() + update.added_edges.size());
  VisibilityGraph scratch = edges_alone(cut.nodes, cut.graph);
  build_neighborhoods(cut.nodes, scratch, tree);
  for (std::uint32_t g = 0; g < GraphStorage::of(cut.graph).guides().size(); ++g) {
    CAPTURE(g);
    REQUIRE(GraphStorage::of(cut.graph).entries(VisibilityGraph::first_guide + g) ==
            GraphStorage::of(scratch).entries(VisibilityGraph::first_guide + g));
  }
  for (std::size_t i = 0; i < cut.nodes.size(); ++i, ++rows_compared) {
    CAPTURE(i);
    REQUIRE(cut.graph.row(NodeId(i)) == scratch.row(NodeId(i)));
    const bool same = i < before.node_count() && before.row(NodeId(i)) == cut.graph.row(NodeId(i));
    const bool listed = std::binary_search(update.updated_nodes.begin(), update.updated_nodes.end(), NodeId(i));
    REQUIRE((same || listed));
  }
}

}  // namespace

TEST_CASE("incremental updates equal a build from scratch, bit for bit") {
  std::size_t rows_compared = 0;
  for (int seed = 1; seed <= cases(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    Cut cut(jittered(random, 8, 0.35, seed % 3 == 0 ? 2 : 1), {}, 26);
    const Vec3 n = random.direction(), a = n.cross(random.direction()).normalized(), b = n.cross(a);
    const auto at = [&](double u, double v) {
      return Vec3(Vec3::Constant(0.5) + (u - 0.6) * a * 1.6 + (v - 0.5) * b * 1.8 + 0.05 * std::sin(5 * u + 3 * v) * n +
                  0.003 * n);
    };
    const int columns = seed % 2 ? 6 : 1;
    for (int step = 0; step < 8; ++step) {
      Soup fresh;
      for (int j = 0; j < columns; ++j) {
        const double u0 = step / 8.0, u1 = (step + 1) / 8.0, v0 = double(j) / columns, v1 = double(j + 1) / columns;
        fresh.push_back({at(u0, v0), at(u1, v0), at(u1, v1)});
        fresh.push_back({at(u0, v0), at(u1, v1), at(u0, v1)});
      }
      const NodeId first(cut.nodes.size());
      const VisibilityGraph before = cut.graph;
      if (seed % 2 == 0)
        for (int i = 0; i < 3; ++i)
          cut.insert({random.uniform(0.1, 0.9), random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)}, 0.22);
      require_as_from_scratch(cut, cut.step(first, {}, fresh), before, rows_compared);
    }
  }
  CHECK(rows_compared > 20000);
}

TEST_CASE("updates are the same for any number of threads") {
  Random random(5);
  const NodeSet nodes = jittered(random, 26, 0.3, 1.3);
  std::vector<VisibilityGraph> graphs;
  std::vector<std::vector<NodeId>> updated;
  for (const int count : {1, 2, 3}) {
    set_threads(count);
    Cut cut(nodes, {}, 26);
    const auto at = [](double u, double v) { return Vec3(u, 0.511 + 0.05 * std::sin(5 * u + 3 * v), v); };
    for (int step = 0; step < 2; ++step) {
      Soup fresh;
      for (int j = 0; j < 6; ++j) {
        const double u0 = 0.45 * step - 0.1, u1 = u0 + 0.45, v0 = j / 5.0 - 0.1, v1 = v0 + 0.2;
        fresh.push_back({at(u0, v0), at(u1, v0), at(u1, v1)});
        fresh.push_back({at(u0, v0), at(u1, v1), at(u0, v1)});
      }
      updated.push_back(cut.step(NodeId(cut.nodes.size()), {}, fresh).updated_nodes);
      graphs.push_back(cut.graph);
    }
  }
  set_threads(0);
  CHECK(updated[1].size() > 1024);  // more than one block of rows
  for (std::size_t g = 2; g < graphs.size(); ++g) {
    CHECK(graphs[g] == graphs[g % 2]);
    CHECK((updated[g] == updated[g % 2]));
  }
}

TEST_CASE("updates with any faces, and nodes inserted, moved, resized and joined") {
  std::size_t rows_compared = 0, cut_edges = 0, added_edges = 0, resized_nodes = 0;
  for (int seed = 1; seed <= cases(10); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Soup walls = random_faces(random, seed % 4);
    const bool guided = seed % 2 == 0;
    Cut cut(jittered(random, 5 + seed % 4, seed % 5 == 0 ? 0 : 0.4, 1 + 2 * random.uniform()), walls,
            8 + static_cast<int>(random.below(25)), random_guides(random, guided ? 12 : 0, walls));
    for (int step = 0; step < 8; ++step) {
      CAPTURE(step);
      const NodeId first(cut.nodes.size());
      const VisibilityGraph before = cut.graph;
      Soup fresh = random_faces(random, static_cast<int>(random.below(4)));
      if (step == 3) fresh.push_back({Vec3(0.2, 0.2, 0.2), Vec3(0.5, 0.5, 0.5), Vec3(0.8, 0.8, 0.8)});  // without area
      std::vector<NodeId> moved;
      for (std::uint32_t m = random.below(3); m > 0; --m) {
        const auto i = random.below(first.value);
        Vec3& p = cut.nodes.position[i];
        cut.grid.erase(i, p);
        p += random.uniform(0, 0.1) * random.direction();
        cut.grid.insert(cut.nodes.position, i);
        if (random.below(2)) cut.nodes.radius[i] *= random.uniform(0.8, 1.0);
        if (std::find(moved.begin(), moved.end(), NodeId(i)) == moved.end()) moved.push_back(NodeId(i));
      }
      std::sort(moved.begin(), moved.end());
      std::vector<std::pair<NodeId, NodeId>> joins;
      for (std::uint32_t m = random.below(3); m > 0; --m) {
        const NodeId i = cut.insert({random.uniform(), random.uniform(), random.uniform()}, random.uniform(0.1, 0.4));
        const NodeId j(random.below(first.value));
        Soup faces = cut.all;
        faces.insert(faces.end(), fresh.begin(), fresh.end());
        if (!TriangleBvh(faces).blocks(cut.nodes.position[j.index()], cut.nodes.position[i.index()]))
          joins.push_back({j, i});
      }
      GuideChange guides{random_guides(random, guided ? static_cast<int>(random.below(6)) : 0, fresh), {}};
      for (std::uint32_t m = guided ? random.below(3) : 0; m > 0; --m) {
        const auto g = VisibilityGraph::first_guide + random.below(GraphStorage::of(cut.graph).guides().size());
        if (std::find(guides.retired.begin(), guides.retired.end(), g) == guides.retired.end())
          guides.retired.push_back(g);
      }
      // Radii alone: of a few anywhere, or of all in a ball.
      std::vector<NodeId> resized;
      if (random.below(2)) {
        const Vec3 middle(random.uniform(), random.uniform(), random.uniform());
        const double around = random.uniform(0, 0.4), by = random.uniform(0.3, 2.5);
        const bool alike = random.below(2);
        for (std::uint32_t i = 0; i < first.value; ++i) {
          if (std::binary_search(moved.begin(), moved.end(), NodeId(i))) continue;
          if (alike ? (cut.nodes.position[i] - middle).norm() > around : random.below(first.value) > 3) continue;
          cut.nodes.radius[i] = std::clamp(cut.nodes.radius[i] * (alike ? by : random.uniform(0.3, 2.5)), 0.02, 0.6);
          resized.push_back(NodeId(i));
        }
      }
      const auto update = cut.step(first, moved, fresh, joins, guides, resized);
      require_as_from_scratch(cut, update, before, rows_compared);
      resized_nodes += resized.size();
      cut_edges += update.cut_edges.size();
      added_edges += update.added_edges.size();
    }
  }
  CHECK(rows_compared > 15000);
  CHECK(cut_edges > 2000);
  CHECK(added_edges > 1000);
  CHECK(resized_nodes > 300);
}

TEST_CASE("updates where a face cuts hardly more than one edge of a guide") {
  std::size_t rows_compared = 0, cut = 0;
  for (int seed = 1; seed <= cases(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Soup walls = random_faces(random, 5);
    Cut body(jittered(random, 6, 0.4, 1 + random.uniform()), walls, 4 + static_cast<int>(random.below(6)),
             random_guides(random, 60, walls));
    for (int step = 0; step < 12; ++step) {
      CAPTURE(step);
      const auto g = VisibilityGraph::first_guide + random.below(GraphStorage::of(body.graph).guides().size());
      const auto row = GraphStorage::of(body.graph).entries(g);
      if (row.to.empty()) continue;
      const Vec3 p = GraphStorage::of(body.graph).position(body.nodes, g),
                 q = GraphStorage::of(body.graph)
                         .position(body.nodes, row.to[random.below(static_cast<std::uint32_t>(row.to.size()))]);
      const Vec3 at = p + random.uniform(0.2, 0.8) * (q - p), u = (q - p).unitOrthogonal(),
                 v = u.cross((q - p).normalized());
      const VisibilityGraph before = body.graph;
      const auto update =
          body.step(NodeId(body.nodes.size()), {}, {{at + 0.002 * u, at + 0.002 * (v - u), at - 0.002 * (v + u)}});
      cut += !(GraphStorage::of(before).entries(g).to.size() == GraphStorage::of(body.graph).entries(g).to.size());
      require_as_from_scratch(body, update, before, rows_compared);
    }
  }
  CHECK(rows_compared > 10000);
  CHECK(cut > 50);
}
