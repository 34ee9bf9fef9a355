// Triangulated polygons, welded seams, summed deltas.
#include <catch2/catch.hpp>

#include "kerf/mesh.h"
#include "surface/delta_sum.h"
#include "surface/face_key.h"
#include "surface/polygon.h"
#include "surface/weld.h"

using namespace geo;

namespace {

double area_of(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).z();
  return sum;
}

}  // namespace

TEST_CASE("a convex polygon is a fan, a concave one is cut into ears of its orientation") {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  CHECK(triangles_of(square, {0, 1, 2, 3}) == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
  // A chevron whose corner 2 is reflex.
  const std::vector<Vec3> chevron{{0, 0, 0}, {2, -1, 0}, {0.5, 0.1, 0}, {2, 1.5, 0}};
  const auto ears = triangles_of(chevron, {0, 1, 2, 3});
  REQUIRE(ears.size() == 2);
  double total = 0;
  for (const auto& t : ears) {
    CHECK(area_of(chevron, {t}) > 0);
    total += area_of(chevron, {t});
  }
  CHECK(total == Approx(area_of(chevron, {{0, 1, 2}, {0, 2, 3}})));
}

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

TEST_CASE("a sum of deltas leaves out what was made and removed again") {
  const auto face = [](std::uint32_t f) { return FaceId(f); };
  const auto vertex = [](std::uint32_t v) { return SurfaceVertexId(v); };
  CrackDelta first, second;
  first.removed_faces = {face(3)}, first.new_faces = {face(10), face(11)};
  first.new_surface_vertices = {vertex(20)}, first.copied_from = {vertex(5)};
  second.removed_faces = {face(10)}, second.new_faces = {face(12)};
  second.new_surface_vertices = {vertex(21)}, second.copied_from = {vertex(20)};
  DeltaSum sum;
  sum.add(first), sum.add(second);
  const CrackDelta total = sum.sum();
  CHECK(total.removed_faces == std::vector{face(3)});
  CHECK(total.new_faces == std::vector{face(11), face(12)});
  CHECK(total.new_surface_vertices == std::vector{vertex(20), vertex(21)});
  CHECK(total.copied_from == std::vector{vertex(5), vertex(5)});
}

TEST_CASE("a face key ignores order, and is_even() tells rotations from reflections") {
  const auto ids = [](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return std::array{VertexId(a), VertexId(b), VertexId(c)};
  };
  CHECK(face_key(ids(5, 2, 9)) == std::array<std::uint32_t, 3>{2, 5, 9});
  CHECK(is_even(ids(2, 5, 9)) == is_even(ids(5, 9, 2)));
  CHECK(is_even(ids(2, 5, 9)) != is_even(ids(5, 2, 9)));
}
