#include "contact/surface/moving_surface.h"

#include <catch2/catch.hpp>

#include "contact/surface/surface_targets.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

TEST_CASE("coincident vertices follow the positions: groups form, and dissolve when a vertex moves") {
  ContactSurface topology;
  topology.triangles = {{0, 1, 2}, {3, 4, 5}};
  topology.site = {7, 8, 9, 7, 8, 3};  // vertices 0 and 3, and 1 and 4, are of one site
  const std::vector<Vec3> start{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  MovingSurface surface(topology, start);
  const auto group = [&](std::uint32_t v) {
    const Coincidence& c = surface.coincidence();
    const auto members = c.coincident[c.representative[v]];
    return std::vector<std::uint32_t>(members.begin(), members.end());
  };
  REQUIRE(group(3) == std::vector<std::uint32_t>{0, 3});
  REQUIRE(group(1) == std::vector<std::uint32_t>{1, 4});
  REQUIRE(group(5) == std::vector<std::uint32_t>{5});  // where vertex 2 is, but of another site
  const std::vector<Vec3> values{{1, 0, 0}, {0, 0, 0}, {0, 5, 0}, {3, 0, 0}, {0, 0, 4}, {0, 0, 0}};
  const std::vector<Vec3> mean = surface.coincidence().averaged(values);
  CHECK(mean == std::vector<Vec3>{{2, 0, 0}, {0, 0, 2}, {0, 5, 0}, {2, 0, 0}, {0, 0, 2}, {0, 0, 0}});
  std::vector<Vec3> moved = start;
  moved[3].z() = 1e-300;
  surface.move_to(moved);
  REQUIRE(group(3) == std::vector<std::uint32_t>{3});
  REQUIRE(group(1) == std::vector<std::uint32_t>{1, 4});
  CHECK(surface.positions() == moved);
  topology.triangles.pop_back();
  surface.replace(topology, start);
  CHECK(surface.fans().triangles().size() == 1);
  REQUIRE(group(3) == std::vector<std::uint32_t>{0, 3});
}

TEST_CASE("remembered targets are those computed anew, after moves and after a cut") {
  const TriangleMesh mesh = make_block({5, 1, 1}, 0.25);
  SampleOptions sampling;
  sampling.spacing = 0.3;
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  Solid solid(body.nodes, body.graph, Material());
  SurfaceWeights weights;
  weights.rebuild(body, solid);
  State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  SurfaceTargetCache cache;
  // At rest the targets are the surface itself.
  const std::vector<Vec3> rest = cache.at(weights, state.displacement);
  for (std::size_t v = 0; v < rest.size(); ++v)
    CHECK((rest[v] - body.surface.point(body.surface.site(SurfaceVertexId(v)))).norm() < 1e-14);
  for (std::size_t i = 0; i < solid.size(); ++i)
    state.displacement[i] = 0.1 * body.nodes.position[i].cwiseProduct(Vec3(1, 2, 3));
  CHECK(cache.at(weights, state.displacement) == surface_targets(weights, state.displacement));
  auto front = begin_front(std::vector<Vec3>{{0.5, -0.3, 1.3}, {0.5, 1.3, 1.3}}, false, 1);
  for (const double z : {0.8, 0.5, 0.3, 0.1}) {
    const BodyDelta delta = split(body, front, {{0.51, -0.3, z}, {0.49, 1.3, z}});
    solid.update(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state);
    weights.mark_changed(body, delta);
    if (z == 0.3) continue;  // two steps before an update
    const auto changed = weights.update(body, solid);
    REQUIRE_FALSE(changed.empty());
    REQUIRE(changed.size() < weights.size());  // else nothing is remembered
    cache.invalidate(changed);
    CHECK(cache.at(weights, state.displacement) == surface_targets(weights, state.displacement));
  }
}
