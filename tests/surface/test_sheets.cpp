// take_sheets(): parts that bound nothing, among others that do.
#include <catch2/catch.hpp>
#include <cmath>

#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

// A grid of squares over the unit square, at height(x, y).
template <class Height>
TriangleMesh sheet_of(int parts, const Height& height) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(parts);
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double x = double(i) / n, y = double(j) / n;
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

// The part of a ball below a height.
TriangleMesh bowl(double height) {
  TriangleMesh mesh = make_sphere(12);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](auto v) { return mesh.vertices[v].z() > height; });
  });
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

}  // namespace

TEST_CASE("flat and wavy sheets are taken out and closed surfaces stay") {
  for (const TriangleMesh& sheet :
       {sheet_of(1, [](double, double) { return 0.0; }),
        sheet_of(10, [](double x, double y) { return 0.1 * std::sin(7 * x + 3 * y); }), bowl(-0.4)}) {
    TriangleMesh mesh = sheet;
    OpenSheetStats stats;
    CHECK(take_sheets(mesh, 0, OpenParts::by_area, &stats).triangles.size() == sheet.triangles.size());
    CHECK(mesh.triangles.empty());
    CHECK(stats.sheets == 1);
    mesh = sheet;
    CHECK(take_sheets(mesh, 0, OpenParts::closed).triangles.empty());
    CHECK(mesh.triangles.size() == sheet.triangles.size());
  }
  for (const TriangleMesh& whole : {make_sphere(4), bowl(0.6)}) {
    TriangleMesh mesh = whole;
    CHECK(take_sheets(mesh).triangles.empty());
    CHECK(mesh.triangles.size() == whole.triangles.size());
  }
  TriangleMesh mesh = bowl(0.6);
  CHECK(!take_sheets(mesh, 0, OpenParts::sheets).triangles.empty());
}

TEST_CASE("a double-sided card is one sheet, but a wall between two cells is dropped") {
  TriangleMesh card = sheet_of(1, [](double x, double) { return 0.2 * x; });
  for (const auto& [a, b, c] : std::vector(card.triangles)) card.triangles.push_back({a, c, b});
  CHECK(take_sheets(card).triangles.size() == 2);
  CHECK(card.triangles.empty());
  // Two tetrahedra with a common face, which each of them has.
  TriangleMesh cells;
  cells.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {0.3, 0.3, -1}};
  cells.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 2}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  CHECK(take_sheets(cells).triangles.empty());
  CHECK(cells.triangles.size() == 6);
  CHECK(check_surface(cells, SelfIntersections::find).first_problem == "");
}

TEST_CASE("sheets beside and around solids are told apart from them") {
  TriangleMesh mesh = make_sphere(4);
  const std::size_t ball = mesh.triangles.size();
  append(mesh, sheet_of(4, [](double, double) { return 3.0; }));
  OpenSheetStats stats;
  CHECK(take_sheets(mesh, 0, OpenParts::by_area, &stats).triangles.size() == 32);
  CHECK(mesh.triangles.size() == ball);
  // Three squares along one edge: their rims are no loops.
  TriangleMesh star;
  star.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {-1, 1, 0}, {-1, 1, 1}, {-1, -1, 0}, {-1, -1, 1}};
  for (const std::uint32_t k : {2u, 4u, 6u}) {
    star.triangles.push_back({0, k, k + 1});
    star.triangles.push_back({0, k + 1, 1});
  }
  CHECK(take_sheets(star).triangles.size() == 6);
}
