// A closed two-sided sheet opens where its targets come apart.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "contact/detection/find_crossings.h"
#include "contact/surface/open_sheets.h"

using namespace geo;

namespace {

// The two coincident sides of a flat sheet of n × n squares, joined along its rim. The upper side
// has its material above, so its triangles face down.
struct ClosedSheet {
  ContactSurface surface;
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> upper;  // copies of inner vertices

  explicit ClosedSheet(std::uint32_t n) {
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
    std::vector<std::uint32_t> copy;
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j) {
        positions.push_back(Vec3(i, j, 0));
        surface.site.push_back(at(i, j));
        copy.push_back(at(i, j));
      }
    for (std::uint32_t i = 1; i < n; ++i)
      for (std::uint32_t j = 1; j < n; ++j) {
        copy[at(i, j)] = static_cast<std::uint32_t>(positions.size());
        upper.push_back(copy[at(i, j)]);
        positions.push_back(Vec3(i, j, 0));
        surface.site.push_back(at(i, j));
      }
    std::uint32_t face = 0;
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j)
        for (const Triangle& t :
             {Triangle{at(i, j), at(i + 1, j), at(i, j + 1)}, Triangle{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}}) {
          surface.triangles.push_back(t);
          surface.side.push_back(2 * face);
          surface.triangles.push_back({copy[t[0]], copy[t[2]], copy[t[1]]});
          surface.side.push_back(2 * face + 1);
          ++face;
        }
    surface.edge = 1;
  }
  std::size_t open(const std::vector<Vec3>& to, double gap, double opening) {
    const VertexFans fans(surface.triangles, positions.size());
    return open_sheets(surface, fans, Coincidence(surface.site, positions), to, gap, opening, positions);
  }
  std::size_t crossings() const {
    return find_crossings(surface.triangles, positions, coincident_representatives(surface.site, positions), true)
        .size();
  }
};

}  // namespace

TEST_CASE("vertices whose targets come apart are separated into their own material", "[open-sheets]") {
  constexpr double gap = 1e-3, opening = 1e-2;
  ClosedSheet sheet(6);
  std::vector<Vec3> to = sheet.positions;
  for (const auto v : sheet.upper) to[v].z() = 0.1;
  CHECK(sheet.open(to, gap, opening) == 25);
  CHECK(sheet.crossings() == 0);
  for (const auto v : sheet.upper) {
    CHECK((sheet.positions[v].z() > 0 && sheet.positions[v].z() <= 0.5 * gap));
    const double below = sheet.positions[sheet.surface.site[v]].z();
    CHECK((below < 0 && below >= -0.5 * gap));
  }
}

TEST_CASE("vertices stay closed if their targets overlap or hardly differ", "[open-sheets]") {
  constexpr double gap = 1e-3, opening = 1e-2;
  ClosedSheet sheet(4);
  const std::vector<Vec3> before = sheet.positions;
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(0, 0, 0.5 * opening), Vec3(0, 0, -0.1), Vec3(2 * opening, 0, 0)}) {
    std::vector<Vec3> to = before;
    for (const auto v : sheet.upper) to[v] += shift;
    CHECK(sheet.open(to, gap, opening) == 0);
    CHECK(sheet.positions == before);
  }
  std::vector<Vec3> to = before;  // slip by more than three times the opening distance
  for (const auto v : sheet.upper) to[v].x() += 4 * opening;
  CHECK(sheet.open(to, gap, opening) == 9);
  CHECK(sheet.crossings() == 0);
}

// The last vertex of a sheet that has opened and slid on: both copies are tips of spikes. In all
// directions.
TEST_CASE("a vertex opens where the sheet is open all around it", "[open-sheets]") {
  constexpr double gap = 1e-3, opening = 1e-2;
  for (int k = 0; k < 12; ++k) {
    INFO("direction " << k);
    const double angle = k * std::numbers::pi / 6;
    const Vec3 by(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.05);
    ClosedSheet sheet(6);
    const std::uint32_t middle = 3 * 7 + 3;
    std::uint32_t tip = 0;
    for (const auto v : sheet.upper) {
      if (sheet.surface.site[v] == middle)
        tip = v;
      else
        sheet.positions[v] += by;
    }
    REQUIRE(sheet.crossings() == 0);
    std::vector<Vec3> to = sheet.positions;
    to[tip] += opening * Vec3::UnitZ();
    to[middle] -= opening * Vec3::UnitZ();
    CHECK(sheet.open(to, gap, opening) == 1);
    CHECK(sheet.crossings() == 0);
    CHECK(sheet.positions[tip] != sheet.positions[middle]);
  }
}

// The edge of a sheet that ends in the skin: the skin's triangles lean out, and are larger.
TEST_CASE("a vertex in the skin opens along the normal of its sheet", "[open-sheets]") {
  constexpr double gap = 1e-3, opening = 1e-2;
  ClosedSheet sheet(4);
  const std::uint32_t middle = 2 * 5 + 2;
  std::uint32_t tip = 0;
  for (const auto v : sheet.upper)
    if (sheet.surface.site[v] == middle) tip = v;
  // A skin triangle at either copy of the middle, both steep, with the same normal.
  const auto first = static_cast<std::uint32_t>(sheet.positions.size());
  sheet.positions.insert(sheet.positions.end(),
                         {Vec3(1.9, 2.4, 9), Vec3(2.1, 2.4, 9), Vec3(1.9, 1.6, -9), Vec3(2.1, 1.6, -9)});
  for (std::uint32_t v = 0; v < 4; ++v) sheet.surface.site.push_back(100 + v);
  const std::uint32_t face = sheet.surface.side.back() / 2;
  sheet.surface.triangles.push_back({tip, first, first + 1});
  sheet.surface.triangles.push_back({middle, first + 3, first + 2});
  sheet.surface.side.insert(sheet.surface.side.end(), {2 * (face + 1), 2 * (face + 2)});
  REQUIRE(sheet.crossings() == 0);
  std::vector<Vec3> to = sheet.positions;
  to[tip].z() += 0.6 * opening;
  to[middle].z() -= 0.6 * opening;
  CHECK(sheet.open(to, gap, opening) == 1);
}
