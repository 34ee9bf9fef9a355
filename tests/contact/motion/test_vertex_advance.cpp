#include "contact/motion/vertex_advance.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/two_sheets.h"

using namespace geo;

namespace {

// Two flat sheets of n × n squares of edge 1, one a little above the other.
struct TwoSheets {
  static constexpr std::uint32_t n = 6;
  std::vector<Triangle> triangles = triangles_of_two_sheets(n);
  std::vector<Vec3> at;
  explicit TwoSheets(double distance)
      : at(place_two_sheets(
            n, [&](std::uint32_t side, std::uint32_t i, std::uint32_t j) { return Vec3(i, j, side * distance); })) {}
  std::size_t crossings() const { return crossings_pair_by_pair(triangles, at, all_apart(at.size())); }
};

}  // namespace

TEST_CASE("vertices advance to free targets, ignore negligible errors, and stop before what is in the way") {
  TwoSheets sheets(0.5);
  const double edge = 1, gap = 0.01;
  std::vector<Vec3> to = sheets.at;
  for (std::size_t v = to.size() / 2; v < to.size(); ++v) to[v].z() += 0.3;  // upwards, free
  to[0].x() -= 0.005;                                                        // negligible
  const Vec3 corner = sheets.at[0];
  advance_vertices(sheets.triangles, to, edge, gap, sheets.at);
  for (std::size_t v = to.size() / 2; v < to.size(); ++v) CHECK(sheets.at[v] == to[v]);
  CHECK(sheets.at[0] == corner);

  const auto [first, count] = seeds(20);
  std::size_t planes = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TwoSheets pressed(0.05);
    const std::vector<Vec3> start = pressed.at;
    std::vector<Vec3> wanted = start;
    // Every vertex wants to be somewhere beyond the other sheet.
    for (std::size_t v = 0; v < wanted.size(); ++v)
      wanted[v] += Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2),
                        (v < wanted.size() / 2 ? 1 : -1) * random.uniform(0.02, 0.3));
    planes += advance_vertices(pressed.triangles, wanted, edge, gap, pressed.at);
    REQUIRE(pressed.crossings() == 0);
    double before = 0, after = 0;
    for (std::size_t v = 0; v < wanted.size(); ++v) {
      before += (start[v] - wanted[v]).norm();
      after += (pressed.at[v] - wanted[v]).norm();
      CHECK((pressed.at[v] - wanted[v]).norm() <= (start[v] - wanted[v]).norm() + 0.1 * edge);
    }
    CHECK(after < before);
  }
  REQUIRE(planes > 0);
}

TEST_CASE("free vertices advance to their targets, and the others keep their places") {
  const double edge = 1, gap = 0.01;
  TwoSheets sheets(0.5);
  const std::vector<Vec3> start = sheets.at;
  std::vector<Vec3> to = start;
  const std::size_t half = to.size() / 2;
  for (std::size_t v = 0; v < half; ++v)
    to[v].z() += v == 0 ? 0.7 : -0.3;  // one through the other sheet, the rest away
  advance_free_vertices(sheets.triangles, to, edge, gap, sheets.at);
  CHECK(sheets.crossings() == 0);
  std::size_t arrived = 0;
  for (std::size_t v = 0; v < half; ++v) arrived += sheets.at[v] == to[v];
  CHECK(sheets.at[0] != to[0]);
  CHECK(arrived > half - 6);  // all but that vertex and those of its triangles
  for (std::size_t v = half; v < to.size(); ++v) CHECK(sheets.at[v] == start[v]);
}
