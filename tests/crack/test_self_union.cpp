// One solid of parts that overlap, touch, cross themselves or have walls inside.
#include <catch2/catch.hpp>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

// `other`: a copy, as it may be `mesh` itself.
void add(TriangleMesh& mesh, TriangleMesh other, const Vec3& to, bool turned = false) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& p : other.vertices) mesh.vertices.push_back(p + to);
  for (auto t : other.triangles) {
    if (turned) std::swap(t[1], t[2]);
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

TriangleMesh united(const TriangleMesh& mesh) {
  TriangleMesh solid = self_union(mesh);
  CHECK_NOTHROW(require_solid(solid));
  return solid;
}

std::size_t shared_positions(const TriangleMesh& mesh, const TriangleMesh& with) {
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  std::set<std::array<double, 3>> had;
  for (const Vec3& p : with.vertices) had.insert(key(p));
  return static_cast<std::size_t>(
      std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec3& p) { return had.count(key(p)) > 0; }));
}

}  // namespace

TEST_CASE("blocks on an integer grid become the union of their cells, at every degeneracy", "[union]") {
  constexpr int n = 4;
  const auto [first, count] = seeds(300);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    TriangleMesh mesh;
    bool full[n][n][n] = {};
    const auto blocks = 2 + random.below(4);
    for (std::uint32_t b = 0; b < blocks; ++b) {
      std::array<int, 3> lo, hi;
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = int(random.below(n));
        hi[k] = lo[k] + 1 + int(random.below(std::uint32_t(n - lo[k])));
      }
      add(mesh, make_block({double(hi[0] - lo[0]), double(hi[1] - lo[1]), double(hi[2] - lo[2])}, n),
          {double(lo[0]), double(lo[1]), double(lo[2])});
      for (int x = lo[0]; x < hi[0]; ++x)
        for (int y = lo[1]; y < hi[1]; ++y)
          for (int z = lo[2]; z < hi[2]; ++z) full[x][y][z] = true;
    }
    const auto cells = std::count(&full[0][0][0], &full[0][0][0] + n * n * n, true);
    const TriangleMesh solid = united(mesh);
    CHECK(signed_volume(solid) == Approx(double(cells)).epsilon(2e-3));  // touching edges are moved by 2⁻¹²
    for (const Vec3& p : solid.vertices) {
      CHECK((p.array() >= 0).all());
      CHECK((p.array() <= n).all());
    }
  }
}

TEST_CASE("balls that overlap become one solid, whose vertices and texture coordinates stay outside", "[union]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    TriangleMesh mesh;
    for (int i = 0; i < 6; ++i) add(mesh, make_sphere(4), 1.2 * random.uniform() * random.direction());
    for (const auto& [a, b, c] : mesh.triangles)
      mesh.attributes.uv.push_back(
          {Vec2(mesh.vertices[a].head<2>()), Vec2(mesh.vertices[b].head<2>()), Vec2(mesh.vertices[c].head<2>())});
    SelfUnionStats stats;
    const TriangleMesh solid = self_union(mesh, {}, &stats);
    CHECK_NOTHROW(require_solid(solid));
    CHECK(stats.cells > 1);
    CHECK(stats.removed_faces > 0);
    CHECK(shared_positions(solid, mesh) > 100);
    REQUIRE(solid.attributes.uv.size() == solid.triangles.size());
    for (std::size_t t = 0; t < solid.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        CHECK((solid.attributes.uv[t][k] - solid.vertices[solid.triangles[t][k]].head<2>()).norm() < 1e-6);
  }
}

TEST_CASE("a sound solid keeps its vertices, cavities stay, and walls inside go", "[union]") {
  const TriangleMesh ball = make_sphere(5);
  const TriangleMesh same = united(ball);
  CHECK(same.triangles.size() == ball.triangles.size());
  CHECK(shared_positions(same, ball) == ball.vertices.size());
  TriangleMesh hollow = ball;
  for (Vec3& p : hollow.vertices) p *= 2;
  add(hollow, ball, Vec3::Zero(), true);
  CHECK(signed_volume(united(hollow)) == Approx(7 * signed_volume(ball)));
  TriangleMesh walled = make_block({2, 1, 1}, 1);
  const auto first = static_cast<std::uint32_t>(walled.vertices.size());
  for (const auto& p : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 0, 1)}) walled.vertices.push_back(p);
  walled.triangles.push_back({first, first + 1, first + 2});
  walled.triangles.push_back({first, first + 2, first + 3});
  CHECK(signed_volume(united(walled)) == Approx(2));
}

TEST_CASE("solids that share one vertex are no solid, and repair parts them there", "[union]") {
  TriangleMesh mesh = make_block({1, 1, 1}, 1);
  add(mesh, mesh, {1, 1, 1});
  // The corner at (1, 1, 1) becomes one vertex.
  std::vector<std::uint32_t> corner;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (mesh.vertices[v] == Vec3(1, 1, 1)) corner.push_back(v);
  REQUIRE(corner.size() == 2);
  for (Triangle& t : mesh.triangles) std::replace(t.begin(), t.end(), corner[1], corner[0]);
  const SurfaceReport report = check_surface(mesh, SelfIntersections::find);
  CHECK(!report.manifold);
  CHECK(report.self_intersections == 0);
  CHECK(report.first_problem == "the surface is not manifold: vertex " + std::to_string(corner[0]) +
                                    " joins 2 fans of triangles; separate the parts that touch there");
  const TriangleMesh solid = repaired_solid(mesh);
  CHECK(check_surface(solid, SelfIntersections::find).first_problem == "");
  CHECK(signed_volume(solid) == Approx(2).epsilon(1e-3));
  CHECK(shared_positions(solid, mesh) >= mesh.vertices.size() - 1);
}

TEST_CASE("what encloses nothing is refused", "[union]") {
  CHECK_THROWS_AS(self_union({}), InputError);
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  CHECK_THROWS_WITH(self_union(sheet), Catch::Contains("encloses no volume"));
  TriangleMesh stray = make_sphere(4);
  stray.vertices[7] = {0, 0, 1e16};
  CHECK_THROWS_WITH(self_union(stray), Catch::Contains("some vertices are far from all others"));
}

TEST_CASE("random soups end as a solid or as one sentence", "[union]") {
  const auto [first, count] = seeds(200);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    TriangleMesh mesh = make_sphere(2);
    for (Vec3& p : mesh.vertices) p += 0.5 * random.uniform() * random.direction();
    for (int i = 0; i < 8; ++i) mesh.triangles.push_back({random.below(42), random.below(42), random.below(42)});
    repair(mesh);
    try {
      require_solid(self_union(mesh));
    } catch (const GeometryError& e) {
      CAPTURE(e.what());
      CHECK(std::string(e.what()).find('\n') == std::string::npos);
    }
  }
}
