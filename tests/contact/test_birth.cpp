#include <catch2/catch.hpp>

#include <cmath>

#include "body/agreement.h"
#include "contact/crossing.h"
#include "contact/self_contact.h"
#include "sampling/sample.h"
#include "surface/shapes.h"

using namespace geo;

TEST_CASE("sheets cut in a body at rest are born together") {
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
      for (int i = 0; i <= 12; ++i) points.push_back({0.52 + 0.48 * blade + 0.3 * (z - 0.6) + 0.02 * std::sin(7 * z + i), -0.2 + 1.4 * i / 12, z});
      return points;
    };
    FrontState front = begin_front(edge(1.3), false, blade + 1);
    for (int step = 1; step <= 8; ++step) {
      const BodyDelta delta = split(body, front, edge(1.3 - 0.14 * step), {}, nullptr,
                                    [&](const Complex& grown, const CrackDelta& crack) { surface.expect(body, solid, state, grown, crack); });
      solid.update(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state);
      surface.follow(body, solid, delta);
      const auto& s = surface.surface();
      for (std::size_t v = 0; v < s.site.size(); ++v)
        if (body.surface.alive(SurfaceVertexId(v))) CHECK((surface.positions()[v] - body.surface.point(VertexId(s.site[v]))).norm() < 1e-14);
      TriangleMesh mesh_now;
      mesh_now.vertices = surface.positions(), mesh_now.triangles = s.triangles, mesh_now.site = s.site;
      CHECK(count_crossings(mesh_now) == 0);
    }
  }
}
