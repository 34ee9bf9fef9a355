// Bodies that stay in step with their surface: by hand on a block, at random on a pumpkin.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/random.h"
#include "body/binding.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "body/node_insertion.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "graph/build_graph.h"
#include "graph/update.h"
#include "invariants/cut_bodies.h"
#include "kerf/body.h"
#include "kerf/error.h"
#include "kerf/graph.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

Body make_body(const TriangleMesh& mesh, double spacing) {
  SampleOptions options;
  options.spacing = spacing;
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, options));
}

double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

}  // namespace

TEST_CASE("A block has one piece, one component and a master for every vertex", "[body]") {
  const Body body = make_body(make_block({1, 1, 1}, 0.25), 0.2);
  const auto report = check_body(body);
  CHECK(report.first_problem == "");
  CHECK(report.pieces == 1);
  CHECK(report.graph_components == 1);
  std::vector<std::pair<NodeId, double>> nodes;
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v) {
    carrier_nodes(body, SurfaceVertexId(v), nodes);
    CHECK(!nodes.empty());
  }
}

TEST_CASE("A node outside the material is refused", "[body]") {
  const auto mesh = make_block({1, 1, 1}, 0.5);
  auto nodes = sample_nodes(mesh, {.spacing = 0.2});
  nodes.position[0] = {2, 0.5, 0.5};
  CHECK_THROWS_AS(build_body(Complex::from_skin(mesh), nodes), InputError);
  CHECK_THROWS_AS(build_body(Complex::from_skin(mesh), NodeSet()), InputError);
}

TEST_CASE("A plane through a block separates nodes, graph and binding", "[body]") {
  const int steps = GENERATE(1, 4);
  Body body = make_body(make_block({1, 1, 1}, 0.25), 0.2);
  const double volume = total(body.nodes.volume);
  auto front = begin_front(std::vector<Vec3>{{0.47, -0.5, -0.5}, {0.47, 1.5, -0.5}}, false, 1);
  for (int s = 1; s <= steps; ++s) {
    const double z = -0.5 + 2.0 * s / steps;
    SplitStats work;
    split(body, front, {{0.47, -0.5, z}, {0.47, 1.5, z}}, {}, &work);
    CHECK(check_body(body).first_problem == "");
  }
  CHECK(find_pieces(body.surface).count == 2);
  CHECK(total(body.nodes.volume) == Approx(volume).epsilon(1e-12));
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
    for (const auto& n : body.graph.neighbors(body.nodes, NodeId(i)))
      CHECK((body.nodes.position[i].x() < 0.47) == (body.nodes.position[n.to.index()].x() < 0.47));
  // A vertex of either side of the cut is carried by nodes of that side.
  std::vector<std::pair<NodeId, double>> nodes;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    for (int which = 0; which < 2; ++which) {
      const Side side{FaceId(f), which};
      if (!body.surface.alive(FaceId(f)) || body.surface.face(FaceId(f)).crack == 0) continue;
      const auto t = body.surface.corners(FaceId(f));
      const bool normal_up = (t[1] - t[0]).cross(t[2] - t[0]).x() > 0;
      carrier_nodes(body, body.surface.surface_vertex(side, 0), nodes);
      for (const auto& [i, d] : nodes)
        CHECK((body.nodes.position[i.index()].x() > 0.47) == (normal_up == (which == 1)));
    }
}

TEST_CASE("Each wall of a cut that ends in the material is carried by nodes of its side", "[body]") {
  const auto [first, count] = seeds(20);
  for (int n = 0; n < count; ++n) {
    INFO("seed " << first + static_cast<std::uint64_t>(n));
    std::mt19937_64 random(first + static_cast<std::uint64_t>(n));
    std::uniform_real_distribution<double> unit(-1, 1);
    const double x = 0.5 + 0.1 * unit(random), depth = 0.4 + 0.1 * unit(random);
    Body body = make_body(make_block({1, 1, 1}, 0.2), 0.12);
    // In steps of random lengths, with uneven fronts: triangles reach the border from everywhere.
    const int steps = 4;
    std::vector<Vec3> at;
    for (int k = 0; k <= 12; ++k) at.push_back({x, -0.1 + 0.1 * k, 1.05});
    auto front = begin_front(at, false, 1);
    for (int s = 1; s <= steps; ++s) {
      for (Vec3& p : at) p.z() = 1.05 - (depth + 0.05) * (s + 0.3 * unit(random)) / steps;
      split(body, front, at);
    }
    CHECK(check_body(body).first_problem == "");
    const Complex& k = body.surface;
    double deepest = 0;  // of the border
    for (const Vec3& p : at) deepest = std::max(deepest, p.z());
    std::size_t checked = 0, wrong = 0;
    for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
      const SurfaceVertexId id(v);
      if (!k.alive(id)) continue;
      const Side side = k.corner_of(id).first;
      if (k.face(side.face).crack == 0 || k.point(k.site(id)).z() < deepest + 0.05) continue;
      const auto t = k.corners(side.face);
      const bool normal_up = (t[1] - t[0]).cross(t[2] - t[0]).x() > 0;
      const auto [node, across] = master_nodes(body, id);
      REQUIRE(node.valid());
      ++checked;
      wrong += across.valid() || (body.nodes.position[node.index()].x() > x) != (normal_up == (side.which == 1));
    }
    CHECK(checked > 40);
    CHECK(wrong == 0);
  }
}

TEST_CASE("A cut through nodes moves them off", "[body]") {
  Body body = make_body(make_block({1, 1, 1}, 0.5), 0.25);
  const double x = body.nodes.position[body.nodes.size() / 2].x();
  auto front = begin_front(std::vector<Vec3>{{x, -0.5, -0.5}, {x, 1.5, -0.5}}, false, 1);
  const auto delta = split(body, front, {{x, -0.5, 1.5}, {x, 1.5, 1.5}});
  CHECK(!delta.moved_nodes.empty());
  CHECK(check_body(body).first_problem == "");
}

TEST_CASE("A thin ligament that a cut leaves gets few nodes, all of them near it", "[body]") {
  const auto [first, count] = seeds(30);
  std::size_t repaired = 0, by_path = 0;
  for (int n = 0; n < count; ++n) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(n);
    INFO("seed " << seed);
    Random random(seed);
    const double spacing = 0.2;
    Body body = make_body(make_block({1, 1, 4}, 0.2), spacing);
    const double volume = std::accumulate(body.nodes.volume.begin(), body.nodes.volume.end(), 0.0);
    // A cut in two steps, across the block but for a strip along one side.
    const double z = random.uniform(1.8, 2.2), tilt = random.uniform(-0.1, 0.1), left = random.uniform(0.005, 0.06);
    const auto edge = [&](double y) {
      std::vector<Vec3> points;
      for (int i = 0; i <= 8; ++i) points.push_back({-0.1 + 0.15 * i, y, z + tilt * (-0.1 + 0.15 * i)});
      return points;
    };
    auto front = begin_front(edge(-0.1), false, 1);
    split(body, front, edge(random.uniform(0.4, 0.7)));
    SplitStats stats;
    split(body, front, edge(1 - left), {}, &stats);
    CHECK(check_body(body).first_problem == "");
    CHECK(find_pieces(body.surface).count == 1);
    repaired += stats.repair_nodes > 0;
    by_path += stats.repair_nodes > 0 && stats.repair_nodes <= 3;
    CHECK(std::accumulate(body.nodes.volume.begin(), body.nodes.volume.end(), 0.0) == Approx(volume));
    CHECK(body.cache->grid.size() == body.nodes.size());
    // Ends of cut edges are within a support radius of the cut, and walls 1.5 spacings farther.
    // Half of the body is ten spacings long.
    for (std::size_t i = body.nodes.size() - stats.repair_nodes; i < body.nodes.size(); ++i)
      CHECK(std::abs(body.nodes.position[i].z() - z) < 6 * spacing);
  }
  CHECK(repaired > 0);
  CHECK(by_path > 0);
}

TEST_CASE("A small crack that grows inside the material needs no repair of the graph", "[body]") {
  const auto [first, count] = seeds(20);
  std::size_t unseen = 0;
  for (int n = 0; n < count; ++n) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(n);
    INFO("seed " << seed);
    Random random(seed);
    Body body = make_body(make_block({1, 1, 1}, 0.1), 0.25);
    body.resample_limit = 0;  // nodes between the crack and the skin would count, too
    const double length = 0.004;
    const Vec3 at(random.uniform(0.1, 0.9), random.uniform(0.1, 0.9), random.uniform(0.02, 0.06));
    const Vec3 along = length * random.direction(), ahead = length * along.cross(random.direction()).normalized();
    auto front = begin_front(std::vector<Vec3>{at, at + along}, false, 1);
    for (int k = 1; k <= 3; ++k) {
      SplitStats stats;
      split(body, front, {Vec3(at + k * ahead), Vec3(at + along + k * ahead)}, {}, &stats);
      CHECK(stats.repair_nodes == 0);
      unseen += body.cache->unseen_masters.size();
    }
    CHECK(check_body(body).first_problem == "");
  }
  CHECK(unseen > 0);
}

TEST_CASE("Following a surface that was cut elsewhere keeps the invariants", "[body]") {
  Body body = make_body(make_pumpkin(5), 0.25);
  Complex cut = body.surface;
  auto front = begin_front(std::vector<Vec3>{{-2, 0.1, -2}, {2, 0.2, -2}}, false, 1);
  advance(cut, front, std::vector<Vec3>{{-2, 0.1, 0}, {2, 0.2, 0}});
  update_body(body, cut);
  CHECK(check_body(body).first_problem == "");
  advance(cut, front, std::vector<Vec3>{{-2, 0.1, 2}, {2, 0.2, 2}});
  update_body(body, cut);
  CHECK(check_body(body).first_problem == "");
  CHECK(find_pieces(body.surface).count == 2);
  CHECK(check_body(body).graph_components == 2);
}

TEST_CASE(
    "Following a surface goes as well far off the origin, where corners of divided faces are off them by rounding",
    "[body]") {
  const Vec3 there(0x1p30, 0, -0x1p30);
  TriangleMesh pumpkin = make_pumpkin(5);
  for (Vec3& v : pumpkin.vertices) v += there;
  Body body = make_body(pumpkin, 0.25);
  Complex cut = body.surface;
  auto front = begin_front(std::vector<Vec3>{there + Vec3(-2, 0.1, -2), there + Vec3(2, 0.2, -2)}, false, 1);
  advance(cut, front, std::vector<Vec3>{there + Vec3(-2, 0.1, 2), there + Vec3(2, 0.2, 2)});
  update_body(body, cut);
  CHECK(check_body(body).first_problem == "");
  CHECK(find_pieces(body.surface).count == 2);
}

TEST_CASE("Following a surface tells how far it is, and stops where it is asked to", "[body]") {
  const Body model = make_body(make_block({1, 1, 1}, 0.25), 0.2);
  Complex cut = model.surface;
  auto front = begin_front(std::vector<Vec3>{{0.47, -1, -1}, {0.47, 2, -1}}, false, 1);
  advance(cut, front, std::vector<Vec3>{{0.47, -1, 2}, {0.47, 2, 2}});
  Body body = model;
  std::vector<std::string> phases;
  update_body(body, cut, nullptr, [&](std::string_view phase, std::size_t done, std::size_t total) {
    CHECK(done < total);
    if (phases.empty() || phases.back() != phase) phases.emplace_back(phase);
    return true;
  });
  CHECK(phases ==
        std::vector<std::string>{"surface", "new nodes", "cut edges", "new edges", "neighbourhoods", "binding"});
  for (const std::string& last : phases) {
    body = model;
    CHECK_THROWS_AS(update_body(body, cut, nullptr,
                                [&](std::string_view phase, std::size_t, std::size_t) { return phase != last; }),
                    Interrupted);
  }
}

TEST_CASE("Random cuts keep a pumpkin's body in step", "[body]") {
  const Body model = make_body(make_pumpkin(5), 0.25);
  const double volume = total(model.nodes.volume);
  random_cuts::cut_bodies(model, 8, 15485863, [&](const Body& body) {
    CHECK(check_body(body).first_problem == "");
    CHECK(total(body.nodes.volume) == Approx(volume).epsilon(1e-12));
  });
}

TEST_CASE("New nodes along a cut of many steps own about as much as the nodes around them", "[body]") {
  const std::uint64_t seed = GENERATE(1, 2, 3);
  CAPTURE(seed);
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, {.spacing = 0.05, .levels = 3, .seed = seed}));
  const std::size_t before = body.nodes.size();
  const double volume = total(body.nodes.volume);
  const auto per_cubed_spacing = [&](std::size_t i) {
    return body.nodes.volume[i] / std::pow(body.nodes.spacing[i], 3);
  };
  auto front = begin_front(std::vector<Vec3>{{0.47, -0.5, -0.5}, {0.48, 1.5, -0.5}}, false, 1);
  for (int s = 1; s <= 40; ++s) {
    const double z = -0.5 + 0.05 * s;
    split(body, front, {{0.47, -0.5, z}, {0.48, 1.5, z}});
  }
  REQUIRE(body.nodes.size() > before + 100);
  // The median of the nearest original nodes.
  for (std::size_t i = before; i < body.nodes.size(); ++i) {
    std::vector<double> around;
    for (const auto j : body.cache->grid.nearest(body.nodes.position, body.nodes.position[i], 9, ~0u,
                                                 [&](std::uint32_t k) { return k < before; }))
      around.push_back(per_cubed_spacing(j));
    std::nth_element(around.begin(), around.begin() + 4, around.end());
    CHECK(per_cubed_spacing(i) > 0.25 * around[4]);
  }
  CHECK(total(body.nodes.volume) == Approx(volume).epsilon(1e-12));
}

TEST_CASE("A donor that gave a half to each of many new nodes gets its share back", "[body]") {
  const Seeds all = seeds(40);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Body body = make_body(make_block({1, 1, 1}, 0.25), 0.25);
    prepare_cache(body);
    const double volume = total(body.nodes.volume);
    NewNodes inserted(body);
    const NodeId donor(static_cast<std::uint32_t>(random.uniform() * double(body.nodes.size())));
    const int count = 2 + static_cast<int>(40 * random.uniform());
    for (int i = 0; i < count; ++i)
      inserted.insert({random.uniform(0.1, 0.9), random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)}, donor, 0.25);
    update_graph({.nodes = body.nodes,
                  .grid = body.cache->grid,
                  .first_new = inserted.first(),
                  .k = body.k,
                  .triangles_near = triangles_near(body.surface)},
                 body.graph);
    const double least = body.nodes.volume[donor.index()];
    even_out_volumes(inserted);
    CHECK(total(body.nodes.volume) == Approx(volume).epsilon(1e-12));
    CHECK(body.nodes.volume[donor.index()] > 1.9 * least);
    for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
      if (i != donor.value && i < inserted.first().value) continue;
      const auto cube = [&](std::uint32_t j) { return std::pow(body.nodes.spacing[j], 3); };
      double near = body.nodes.volume[i], cubes = cube(i);
      for (const auto& n : body.graph.neighbors(body.nodes, NodeId(i))) {
        near += body.nodes.volume[n.to.index()];
        cubes += cube(n.to.value);
      }
      CHECK(body.nodes.volume[i] >= 0.49 * near / cubes * cube(i));
    }
  }
}

TEST_CASE("Nodes whose neighbours do not span space are debris", "[body]") {
  // A flat sheet of nodes, then one of them lifted, more and more.
  for (const double lift : {0.0, 1e-3, 0.4}) {
    CAPTURE(lift);
    Body body;
    for (int i = 0; i < 25; ++i) {
      const bool lifted = i % 5 == 2 && i / 5 == 2;
      body.nodes.position.push_back({0.1 * (i % 5), 0.1 * (i / 5), lifted ? 0.1 * lift : 0.0});
      body.nodes.radius.push_back(0.25);
      body.nodes.spacing.push_back(0.1);
      body.nodes.volume.push_back(1e-3);
    }
    body.debris.assign(25, 2);
    const TriangleBvh nothing;
    body.graph = build_visibility_graph(body.nodes, nothing, 8);
    build_neighborhoods(body.nodes, body.graph, nothing);
    std::vector<NodeId> all;
    for (std::uint32_t i = 0; i < 25; ++i) all.push_back(NodeId(i));
    mark_debris(body, all);
    CHECK(std::count(body.debris.begin(), body.debris.end(), 1) == (lift < 0.1 ? 25 : 4));
  }
}

TEST_CASE("New nodes at a crack grade smoothly from fine to coarse", "[body]") {
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.1);
  SampleOptions sampling;
  sampling.spacing = 0.03;
  sampling.levels = 4;
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  const NodeSet before = body.nodes;
  CHECK(body.finest_spacing == *std::min_element(before.spacing.begin(), before.spacing.end()));
  const double coarsest = *std::max_element(before.spacing.begin(), before.spacing.end());
  REQUIRE(coarsest >= 4 * body.finest_spacing);
  auto front = begin_front(std::vector<Vec3>{{0.473, -0.5, -0.5}, {0.481, 1.5, -0.5}}, false, 1);
  for (const double z : {0.4, 0.8, 1.5}) split(body, front, {{0.473, -0.5, z}, {0.481, 1.5, z}});
  CHECK(check_body(body).first_problem == "");
  const std::size_t all = body.nodes.size();
  REQUIRE(all > before.size() + 100);
  std::size_t inside = 0;
  CHECK(total(body.nodes.volume) == Approx(total(before.volume)).epsilon(1e-12));
  for (std::size_t i = before.size(); i < all; ++i) {
    const Vec3& x = body.nodes.position[i];
    const double spacing = body.nodes.spacing[i];
    // Among the original nodes: at least half as far apart as the closest ones, no farther
    // than the farthest.
    double least = coarsest, most = 0;
    for (std::size_t j = 0; j < before.size(); ++j)
      if ((before.position[j] - x).norm() < 2 * coarsest) {
        least = std::min(least, before.spacing[j]);
        most = std::max(most, before.spacing[j]);
      }
    CHECK(spacing >= std::max(body.finest_spacing, 0.5 * least));
    CHECK(spacing <= most);
    if (std::min({x.y(), 1 - x.y(), x.z(), 1 - x.z()}) > 0.35) {
      CHECK(spacing > 1.5 * body.finest_spacing);  // the middle of the crack is not as fine as its rim
      ++inside;
    }
    CHECK(body.graph.neighbor_count(NodeId(i)) >= 6);
    CHECK(body.nodes.radius[i] >= 1.2 * spacing);
  }
  CHECK(inside > 5);
}

TEST_CASE("Segments in a box are blocked by the faces read for the box as by the whole complex", "[body]") {
  Complex complex = Complex::from_skin(make_block({2, 1, 1}, 0.25));
  auto front = begin_front(std::vector<Vec3>{{0.75, -1, -1}, {0.75, -1, 2}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{0.75, 0.5, -1}, {0.75, 0.5, 2}});
  std::size_t blocked = 0, open = 0;
  for (int seed = 1; seed <= cases(40); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    // Every other box on a lattice, where segments touch faces, edges and corners.
    const auto any = [&] {
      return seed % 2 ? Vec3(random.uniform(0, 2), random.uniform(), random.uniform())
                      : Vec3(0.25 * Vec3(random.below(9), random.below(5), random.below(5)));
    };
    Box3 box;
    box.add(any());
    box.add(any());
    const BoxVisibility sight(complex, box);
    for (int k = 0; k < 50; ++k) {
      const Vec3 p = any().cwiseMax(box.lo).cwiseMin(box.hi), q = any().cwiseMax(box.lo).cwiseMin(box.hi);
      const bool expected = is_blocked(complex, p, q);
      CHECK(sight.blocked(p, q) == expected);
      ++(expected ? blocked : open);
    }
  }
  CHECK(blocked > 100);
  CHECK(open > 100);
}
