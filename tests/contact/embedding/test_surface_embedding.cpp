#include <catch2/catch.hpp>

#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "contact/cut_body.h"
#include "contact/self_contact.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

TEST_CASE("sheets cut in a body at rest are embedded at rest, and coincide") {
  const double spacing = 0.27;
  const TriangleMesh mesh = make_block({2, 1, 1.2}, 0.17);
  SampleOptions sampling;
  sampling.spacing = spacing;
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  Solid solid(body.nodes, body.graph, Material());
  State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  SelfContact surface(body, solid);
  for (int blade = 0; blade < 2; ++blade) {
    const auto edge = [&](double z) {
      std::vector<Vec3> points;
      for (int i = 0; i <= 12; ++i)
        points.push_back({0.52 + 0.48 * blade + 0.3 * (z - 0.6) + 0.02 * std::sin(7 * z + i), -0.2 + 1.4 * i / 12, z});
      return points;
    };
    FrontState front = begin_front(edge(1.3), false, blade + 1);
    for (int step = 1; step <= 8; ++step) {
      cut(body, solid, state, surface, front, edge(1.3 - 0.14 * step));
      const auto& s = surface.surface();
      for (std::size_t v = 0; v < s.site.size(); ++v)
        if (body.surface.alive(SurfaceVertexId(v)))
          CHECK((surface.positions()[v] - body.surface.point(VertexId(s.site[v]))).norm() < 1e-14);
      CHECK(count_crossings(mesh_of(surface)) == 0);
    }
  }
}

TEST_CASE("the two sides of a folded sheet cut in a bent body coincide", "[campaign]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    SampleOptions sampling;
    sampling.spacing = 0.27;
    sampling.seed = seed;
    const TriangleMesh mesh = make_block({1, 1, 1}, 0.2);
    Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
    Solid solid(body.nodes, body.graph, Material());
    State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
    const auto bend = [&](std::size_t from) {
      for (std::size_t i = from; i < solid.size(); ++i) {
        const Vec3& x = body.nodes.position[i];
        state.displacement[i] = {0.1 * x.z() * x.z(), 0.05 * x.x() * x.z(), -0.1 * x.x() * x.x()};
      }
    };
    bend(0);
    SelfContact surface(body, solid);
    surface.finish_step_with_impulses(body, solid, state.displacement, 1, {}, state);
    const auto edge = [&](double z) {
      std::vector<Vec3> points;
      for (int i = 0; i <= 10; ++i)
        points.push_back({0.5 + random.uniform(-0.1, 0.1), -0.15 + 0.13 * i + random.uniform(-0.2, 0.2),
                          z + random.uniform(-0.2, 0.2)});
      return points;
    };
    FrontState front = begin_front(edge(1.2), false, 1);
    for (int step = 1; step <= 8; ++step) {
      const std::size_t known = solid.size();
      const BodyDelta delta = cut(body, solid, state, surface, front, edge(1.2 - 0.18 * step));
      bend(known);
      const ContactSurface &grown = surface.surface(), made = contact_surface(body.surface);
      CHECK(grown.triangles == made.triangles);
      CHECK(grown.side == made.side);
      CHECK(grown.site == made.site);
      CHECK(grown.edge == made.edge);
      for (const FaceId f : delta.crack.new_crack_faces)
        for (int c = 0; c < 3; ++c)
          CHECK(surface.positions()[body.surface.surface_vertex({f, 0}, c).index()] ==
                surface.positions()[body.surface.surface_vertex({f, 1}, c).index()]);
    }
  }
}
