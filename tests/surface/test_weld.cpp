// Welded seams.
#include <catch2/catch.hpp>

#include "kerf/mesh.h"
#include "surface/weld.h"

using namespace geo;

TEST_CASE("welding restores a mesh whose triangles were separated") {
  const TriangleMesh ball = make_sphere(3);
  TriangleMesh soup;
  for (const auto& t : ball.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const auto v : t) soup.vertices.push_back(ball.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  CHECK(weld_seams(soup) == 3 * ball.triangles.size() - ball.vertices.size());
  CHECK(soup.vertices.size() == ball.vertices.size());
  CHECK(signed_volume(soup) == Approx(signed_volume(ball)));
  CHECK(weld_seams(soup) == 0);
}

TEST_CASE("welding within a reach keeps the lowest vertex, and the order of the others") {
  TriangleMesh mesh;
  // Two triangles side by side, whose common edge is stored twice, the second time a little apart.
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.001, 0, 0}, {1, 1, 0}, {0, 1.001, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  TriangleMesh exact = mesh;
  CHECK(weld_seams(exact) == 0);
  CHECK(weld_seams(mesh, 0.01) == 2);
  CHECK(mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}});
}

TEST_CASE("a triangle whose corners merge becomes degenerate and keeps its place") {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.001, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  CHECK(weld_seams(mesh, 0.01) == 1);
  CHECK(mesh.triangles == std::vector<Triangle>{{0, 0, 1}, {2, 3, 4}});
}
