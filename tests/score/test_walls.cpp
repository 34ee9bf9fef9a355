#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "geometry/predicates.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "score/jagged.h"
#include "score/join.h"
#include "score/partial.h"
#include "score/voronoi.h"
#include "score/walls.h"

using namespace geo;

namespace {

std::size_t nearest(const std::vector<Vec3>& sites, const Vec3& p) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < sites.size(); ++i)
    if ((p - sites[i]).squaredNorm() < (p - sites[best]).squaredNorm()) best = i;
  return best;
}

// How many walls the segment crosses, by tests of each.
int crossings(const TriangleMesh& walls, const Vec3& p, const Vec3& q) {
  int count = 0;
  for (const auto& t : corners_of(walls)) count += segment_meets_triangle(p, q, t[0], t[1], t[2]);
  return count;
}

bool cross_each_other(const TriangleMesh& walls) {
  const auto corners = corners_of(walls);
  for (std::size_t s = 0; s < corners.size(); ++s)
    for (std::size_t t = 0; t < s; ++t)
      if (faces_cross(walls.triangles[s], corners[s], walls.triangles[t], corners[t])) return true;
  return false;
}

}  // namespace

TEST_CASE("Voronoi walls stand where the nearest site changes", "[voronoi]") {
  const auto [first, count] = seeds(24);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    std::vector<Vec3> sites(2 + random.below(20));
    for (Vec3& s : sites)
      for (int k = 0; k < 3; ++k) s[k] = random.uniform(0, k + 1);
    if (seed % 4 == 0)  // on a lattice: many cells meet in each corner
      for (std::size_t i = 0; i < sites.size(); ++i)
        sites[i] = Vec3(double(i % 3) * 0.3 + 0.1, double(i / 3 % 3) * 0.5 + 0.2, double(i / 9) * 0.7 + 0.3);
    const Box3 box{{0, 0, 0}, {1, 2, 3}};
    const TriangleMesh walls = voronoi_walls(sites, box);
    REQUIRE_FALSE(cross_each_other(walls));
    for (int i = 0; i < 100; ++i) {
      Vec3 p, q;
      for (int k = 0; k < 3; ++k) {
        p[k] = random.uniform(0, k + 1);
        q[k] = random.uniform(0, k + 1);
      }
      // Cells are convex: the segment meets no wall exactly when both ends are in one.
      if (seed % 4 != 0) CHECK((crossings(walls, p, q) == 0) == (nearest(sites, p) == nearest(sites, q)));
    }
    // As cracks in the box: a piece for each cell, nothing beside them.
    TriangleMesh block = make_block({0.98, 1.96, 2.94}, 10);
    for (Vec3& p : block.vertices) p += Vec3(0.01, 0.02, 0.03);
    std::set<std::size_t> met;
    for (int i = 0; i < 2000; ++i)
      met.insert(nearest(sites, {random.uniform(0.01, 0.99), random.uniform(0.02, 1.98), random.uniform(0.03, 2.97)}));
    Complex complex = Complex::from_skin(block);
    insert_sheet(complex, walls, 1);
    CHECK(find_pieces(complex).count >= met.size());
    CHECK(find_pieces(complex).count <= sites.size());
    CHECK(check_complex(complex, SelfIntersections::find).good());
  }
}

TEST_CASE("Voronoi cells of too few, doubled or distant sites are refused", "[voronoi]") {
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  CHECK_THROWS_AS(voronoi_walls(std::vector<Vec3>{{0.5, 0.5, 0.5}}, box), InputError);
  CHECK_THROWS_AS(voronoi_walls(std::vector<Vec3>{{0.5, 0.5, 0.5}, {0.2, 0.1, 0.3}, {0.5, 0.5, 0.5}}, box), InputError);
  CHECK_THROWS_AS(voronoi_walls(std::vector<Vec3>{{0.5, 0.5, 0.5}, {0.2, 0.1, 1.3}}, box), InputError);
}

TEST_CASE("Sheets that cross are divided where they do", "[walls]") {
  // Two squares that cross in a line, and one that touches both.
  const auto square = [](const Vec3& o, const Vec3& u, const Vec3& v) {
    TriangleMesh m;
    m.vertices = {o, o + u, o + u + v, o + v};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
  };
  const std::vector<TriangleMesh> sheets{square({-1, -1, 0.1}, {2, 0, 0}, {0, 2, 0}),
                                         square({-1, 0.2, -1}, {2, 0, 0}, {0, 0, 2}),
                                         square({0.3, 0.2, 0.1}, {0, 0.5, 0}, {0, 0, 0.5})};
  const TriangleMesh walls = divided_by_each_other(sheets, {{-2, -2, -2}, {2, 2, 2}});
  CHECK(area(walls) == Approx(4 + 4 + 0.25));
  CHECK_FALSE(cross_each_other(walls));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : walls.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  CHECK(std::any_of(uses.begin(), uses.end(), [](const auto& u) { return u.second == 4; }));
  CHECK(std::any_of(uses.begin(), uses.end(), [](const auto& u) { return u.second == 3 || u.second == 5; }));
}

TEST_CASE("A grid has walls only where labels differ", "[walls]") {
  const std::array<std::vector<double>, 3> at{{{0, 1, 2, 3}, {0, 1, 2}, {0, 1, 2}}};
  const Mat3 frame = frame_along({1, 2, 3});
  CHECK((frame.transpose() * frame - Mat3::Identity()).norm() < 1e-14);
  CHECK(frame.determinant() == Approx(1));
  CHECK(frame.col(2).dot(Vec3(1, 2, 3).normalized()) == Approx(1));
  CHECK(area(grid_walls(
            at, [](int i, int, int) { return i; }, frame)) == Approx(8));
  CHECK(area(grid_walls(
            at, [](int i, int, int) { return i / 2; }, frame)) == Approx(4));
  CHECK(grid_walls(
            at, [](int, int, int) { return 7; }, frame)
            .triangles.empty());
  CHECK_THROWS_AS(frame_along({0, 0, 0}), InputError);
}

TEST_CASE("Jagged walls meet where flat ones did and do not cross", "[jagged]") {
  const auto [first, count] = seeds(4);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    const TriangleMesh ball = make_sphere(4);
    const TriangleBvh skin(corners_of(ball));
    std::vector<Vec3> sites(6);
    for (Vec3& s : sites) s = 0.8 * random.uniform() * random.direction();
    TriangleMesh walls = voronoi_walls(sites, skin.box().grown(1));
    JaggedOptions options;
    options.amplitude = random.uniform(0, 0.15);
    options.frequency = random.uniform(1, 3);
    options.seed = seed;
    const auto of_edges = [](const TriangleMesh& m) {
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
      for (const auto& t : m.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
      return uses;
    };
    roughen_walls(walls, skin, options);
    CHECK_FALSE(cross_each_other(walls));
    // No edge inside is open: walls end where they meet or in air.
    for (const auto& [edge, times] : of_edges(walls))
      if (times == 1)
        CHECK_FALSE((skin.inside(walls.vertices[edge.first]) && skin.inside(walls.vertices[edge.second])));
    Complex complex = Complex::from_skin(ball);
    insert_sheet(complex, walls, 1);
    CHECK(check_complex(complex, SelfIntersections::find).good());
    const Pieces pieces = find_pieces(complex);
    CHECK(pieces.count >= 2);
    for (std::uint32_t f = 0; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack > 0)
        REQUIRE(pieces.of_side[2 * f] != pieces.of_side[2 * f + 1]);
    // Small pieces are joined one by one, down to one, and no wall is left over.
    for (std::uint32_t wanted = pieces.count; wanted >= 1; --wanted) {
      TriangleMesh fewer = walls;
      const auto promised = join_small_pieces(fewer, complex, 1, pieces, wanted);
      Complex joined = Complex::from_skin(ball);
      insert_sheet(joined, fewer, 1);
      const Pieces left = find_pieces(joined);
      CHECK(left.count == promised);
      CHECK(promised >= wanted);
      if (wanted == pieces.count) CHECK(fewer.triangles == walls.triangles);
      for (std::uint32_t f = 0; f < joined.face_count(); ++f)
        if (joined.alive(FaceId(f)) && joined.face(FaceId(f)).crack > 0)
          REQUIRE(left.of_side[2 * f] != left.of_side[2 * f + 1]);
    }
  }
  TriangleMesh none;
  JaggedOptions wrong;
  wrong.amplitude = -1;
  CHECK_THROWS_AS(roughen_walls(none, TriangleBvh(corners_of(make_sphere(1))), wrong), InputError);
}

TEST_CASE("A partial score ends in an even line, at the depth wanted", "[partial]") {
  const TriangleBvh skin(corners_of(make_sphere(12)));
  TriangleMesh walls;
  walls.vertices = {{-2, -2, 0.01}, {2, -2, 0.02}, {2, 2, 0}, {-2, 2, 0.01}};
  walls.triangles = {{0, 1, 2}, {0, 2, 3}};
  const double longest = 0.1;
  refine_walls(walls, skin, longest, 0.2);
  for (const double depth : {0.3, 0.6, 0.9}) {
    TriangleMesh kept = walls;
    keep_shallow(kept, skin, depth);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const auto& t : kept.triangles)
      for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
    int rim = 0;
    for (const auto& [edge, times] : uses) {
      CHECK(times <= 2);
      if (times == 1 && skin.inside(kept.vertices[edge.first]) && skin.inside(kept.vertices[edge.second])) {
        ++rim;
        for (const auto v : {edge.first, edge.second})
          CHECK(skin.closest(kept.vertices[v]).distance == Approx(depth).margin(0.06 * longest + 0.02));
      }
    }
    CHECK(rim > 12);
    CHECK_FALSE(cross_each_other(kept));
  }
  CHECK_THROWS_AS(keep_shallow(walls, skin, 1), InputError);
}
