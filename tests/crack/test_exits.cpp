// Where a front's line leaves the material.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "crack/classify.h"
#include "crack/exits.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

std::vector<std::array<Vec3, 3>> fan_of(const TriangleMesh& mesh, std::uint32_t v) {
  std::vector<std::array<Vec3, 3>> fan;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] == v) fan.push_back({mesh.vertices[v], mesh.vertices[t[(k + 1) % 3]], mesh.vertices[t[(k + 2) % 3]]});
  return fan;
}

// A bar along y with a valley in its upper face, turned and moved somewhere.
struct Bar {
  explicit Bar(Random& random)
      : turn(Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix()),
        off(random.uniform(), random.uniform(), random.uniform()) {
    const double outline[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {0, 0}, {-1, 1}};
    for (int end = 0; end < 2; ++end)
      for (const auto& p : outline) mesh.vertices.push_back(at(p[0], 2 * end, p[1]));
    for (std::uint32_t i = 0; i < 5; ++i) {
      const std::uint32_t j = (i + 1) % 5;
      mesh.triangles.push_back({i, j + 5, j});
      mesh.triangles.push_back({i, i + 5, j + 5});
      if (i != 3 && j != 3) {
        mesh.triangles.push_back({3, i, j});
        mesh.triangles.push_back({8, j + 5, i + 5});
      }
    }
    if (signed_volume(mesh) < 0)
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  }
  Vec3 at(double x, double y, double z) const { return turn * Vec3(x, y, z) + off; }

  Mat3 turn;
  Vec3 off;
  TriangleMesh mesh;
};

}  // namespace

TEST_CASE("a line begins inside where points near its beginning are", "[exits]") {
  const TriangleMesh mesh = make_pumpkin(5);
  const Complex k = Complex::from_skin(mesh);
  Random random(3);
  int inside = 0;
  const int count = 4000;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t v = random.below(static_cast<std::uint32_t>(mesh.vertices.size()));
    const Vec3 way = random.direction();
    const bool begins =
        begins_inside(mesh.vertices[v], mesh.vertices[v] + random.uniform(0.1, 3) * way, fan_of(mesh, v));
    CAPTURE(i, v);
    CHECK(begins == crack::inside_material(k, mesh.vertices[v] + 1e-6 * way));
    inside += begins;
  }
  CHECK(inside > count / 4);
  CHECK(inside < 3 * count / 4);
}

TEST_CASE("a line along a face or an edge does not begin inside, one beside them does or does not", "[exits]") {
  const TriangleMesh cube = make_block({2, 2, 2}, 1);
  for (std::uint32_t v = 0; v < cube.vertices.size(); ++v) {
    const Vec3& u = cube.vertices[v];
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const Vec3 way(x, y, z), next = u + 0.5 * way;
          if (way.isZero()) continue;
          const bool in = (next.array() > 0).all() && (next.array() < 2).all();
          CAPTURE(u.transpose(), way.transpose());
          CHECK(begins_inside(u, u + way, fan_of(cube, v)) == in);
        }
  }
}

TEST_CASE("a complete cut that grazes a valley separates", "[exits]") {
  // In some of these (the first is 50) rounding would move the front's line through the valley, a
  // hundred ulps long, into the material.
  const Seeds which = seeds(600);
  int refused = 0;
  for (int i = 0; i < which.count; ++i) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(i);
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Bar bar(random);
    const double slope = random.uniform(0.4, 0.8), middle = random.uniform(0.7, 1.3);
    const auto row = [&](double y) {
      return std::vector<Vec3>{bar.at(-1.5 - 0.1 * random.uniform(), y, slope * (y - middle)),
                               bar.at(1.5, y, slope * (y - middle))};
    };
    Complex k = Complex::from_skin(bar.mesh);
    FrontState front = begin_front(row(-0.3), false, 1);
    try {
      advance(k, front, row(middle));
      advance(k, front, row(2.3));
    } catch (const GeometryError&) {
      ++refused;
      continue;
    }
    const auto report = check_complex(k, SelfIntersections::find);
    CHECK(report.first_problem == "");
    CHECK(find_pieces(k).count >= 2);
  }
  CHECK(refused <= 1 + which.count / 50);
}
