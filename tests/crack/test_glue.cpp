// Glued scores: taken out of the complex and opened again in any order, they leave what a cut along
// the whole score leaves.
#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/glue.h"
#include "kerf/pieces.h"
#include "kerf/score.h"

using namespace geo;

namespace {

struct Scored {
  Complex whole;  // the model, its skin divided along the outlines of walls
  Complex cut;    // along the score
  GluedBonds glued;
};

Scored random_score(Random& random) {
  const auto kind = random.below(3);
  const TriangleMesh mesh = kind == 0 ? make_block({1.5, 1, 0.5}, 0.25) : kind == 1 ? make_sphere(5) : make_pumpkin(8);
  const Complex model = Complex::from_skin(mesh);
  ScoreOptions options;
  options.pieces = 3 + static_cast<int>(random.below(15));
  options.pattern.pattern = random.below(2) == 0 ? Pattern::voronoi : Pattern::crossing;
  options.pattern.seed = random.below(1000000);
  Scored scored;
  scored.cut = model;
  insert_sheet(scored.cut, make_score(model, options).sheet, 1);
  scored.whole = scored.cut;
  glue_crack(scored.whole, 1, scored.glued);
  return scored;
}

double crack_area(const Complex& complex) {
  double area = 0;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    const auto c = complex.corners(FaceId(f));
    area += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
  }
  return area;
}

void check_same_pieces(const Complex& opened, const Complex& cut) {
  const Pieces a = find_pieces(opened), b = find_pieces(cut);
  REQUIRE(a.count == b.count);
  for (std::size_t p = 0; p < a.count; ++p) CHECK(a.volume[p] == Approx(b.volume[p]).epsilon(1e-9).margin(1e-12));
}

}  // namespace

TEST_CASE("glued walls leave a whole model, and opened in any order the pieces of the score", "[glue]") {
  const auto [first, count] = seeds(40);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Scored s = random_score(random);
    REQUIRE(check_complex(s.whole, SelfIntersections::find).good());
    REQUIRE(find_pieces(s.whole).count == 1);
    double area = 0;
    for (const GluedBond& bond : s.glued.bonds) area += bond.area;
    CHECK(area == Approx(crack_area(s.cut)));
    std::vector<std::uint32_t> order(s.glued.bonds.size());
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    std::int32_t crack = 0;
    for (std::size_t begin = 0; begin < order.size();) {
      const std::size_t end = std::min(order.size(), begin + 1 + random.below(5));
      const std::vector<std::uint32_t> bonds(order.begin() + std::ptrdiff_t(begin),
                                             order.begin() + std::ptrdiff_t(end));
      const CrackDelta delta = insert_sheet(s.whole, sheet_of(s.glued, bonds), ++crack);
      // The skin was divided along the outlines before: nothing is divided now.
      CHECK(delta.removed_faces.empty());
      begin = end;
    }
    CHECK(check_complex(s.whole, SelfIntersections::find).good());
    check_same_pieces(s.whole, s.cut);
    CHECK(crack_area(s.whole) == Approx(area));
  }
}

TEST_CASE("a blade may cut glued walls before they open", "[glue]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Scored s = random_score(random);
    const Vec3 middle = s.whole.extent().center(), normal = random.direction();
    const Vec3 u = 4 * normal.unitOrthogonal(), v = normal.cross(u);
    TriangleMesh plane;
    plane.vertices = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
    plane.triangles = {{0, 1, 2}, {0, 2, 3}};
    std::vector<std::uint32_t> all(s.glued.bonds.size());
    std::iota(all.begin(), all.end(), 0);
    insert_sheet(s.whole, plane, 1);
    insert_sheet(s.whole, sheet_of(s.glued, all), 2);
    insert_sheet(s.cut, plane, 2);
    CHECK(check_complex(s.whole, SelfIntersections::find).good());
    check_same_pieces(s.whole, s.cut);
  }
}

TEST_CASE("a bond knows its cells, area, direction and place", "[glue]") {
  Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.5));
  TriangleMesh wall;
  wall.vertices = {{0.7, -1, -1}, {0.7, 3, -1}, {0.7, -1, 3}};
  wall.triangles = {{0, 1, 2}};
  insert_sheet(block, wall, 1);
  GluedBonds glued;
  glue_crack(block, 1, glued);
  REQUIRE(glued.bonds.size() == 1);
  const GluedBond& bond = glued.bonds[0];
  CHECK(bond.a == 0);  // the larger piece comes first: the wall's normal points from it to the other
  CHECK(bond.b == 1);
  CHECK(bond.area == Approx(1));
  CHECK((bond.normal - Vec3(-1, 0, 0)).norm() < 1e-12);
  CHECK((bond.centroid - Vec3(0.7, 0.5, 0.5)).norm() < 1e-12);
  CHECK(find_pieces(block).count == 1);
}
