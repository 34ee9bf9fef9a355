// Borders of cracks that no front follows, and cuts through thin material ahead of them.
#include "simulation/fracture_ligaments.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "crack/block_cuts.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "simulation/notched_block.h"

using namespace geo;

namespace {

using Edge = std::pair<VertexId, VertexId>;

// The edges where a crack ends in the material.
std::map<Edge, int> borders_of(const Complex& k, std::int32_t crack) {
  std::map<Edge, int> borders;
  for (std::uint32_t f = 0; f < k.face_count(); ++f) {
    const auto& face = k.face(FaceId(f));
    for (std::size_t e = 0; e < 3 && face.alive && face.crack == crack; ++e)
      if (k.faces_around(face.v[e], face.v[(e + 1) % 3]).size() == 1)
        borders[std::minmax(face.v[e], face.v[(e + 1) % 3])] = 0;
  }
  return borders;
}

}  // namespace

TEST_CASE("the borders of a crack are traced once each, less those that a front follows") {
  const auto [first, count] = seeds(60);
  std::size_t traced = 0, followed = 0, loops = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.4));
    std::vector<GrowingFront> fronts;
    if (random.below(3) == 0) {  // a crack inside, whose border is a loop
      TriangleMesh sheet;
      for (int i = 0; i < 4; ++i)
        sheet.vertices.push_back({0.3 + 0.4 * (i / 2), 0.3 + 0.4 * (i % 2), random.uniform(0.4, 0.6)});
      sheet.triangles = {{0, 2, 1}, {1, 2, 3}};
      insert_sheet(k, sheet, 1);
    } else {
      const auto rows = block_cut(random);
      FrontState front = begin_front(rows[0], false, 1);
      for (std::size_t s = 1, steps = 1 + random.below(4); s <= steps; ++s) advance(k, front, rows[s]);
      if (random.below(2) == 0) fronts.push_back(growing(front, std::vector<Vec3>(front.points.size(), Vec3::UnitZ())));
    }
    auto expected = borders_of(k, 1);
    for (const GrowingFront& g : fronts)
      for (const auto& segment : g.front.segments)
        for (std::size_t i = 1; i < segment.size(); ++i)
          followed += expected.erase(std::minmax(segment[i - 1].id, segment[i].id));
    const auto found = unfollowed_borders(k, 1, k.extent(), fronts);
    for (const FrontState& border : found) {
      CHECK(border.crack == 1);
      CHECK(border.segments.size() == border.points.size() - (border.closed ? 0 : 1));
      loops += border.closed;
      for (std::size_t i = 0; i < border.segments.size(); ++i) {
        const auto& segment = border.segments[i];
        REQUIRE(segment.size() == 2);
        CHECK(segment[0].id == border.points[i].id);
        CHECK(segment[1].id == border.points[(i + 1) % border.points.size()].id);
        for (const auto& p : segment) CHECK(p.position == k.point(p.id));
        const auto at = expected.find(std::minmax(segment[0].id, segment[1].id));
        REQUIRE(at != expected.end());
        CHECK(++at->second == 1);
      }
    }
    for (const auto& [edge, times] : expected) CHECK(times == 1);
    traced += expected.size();
    CHECK(unfollowed_borders(k, 2, k.extent(), fronts).empty());
  }
  CHECK(traced > 100);
  CHECK(followed > 20);
  CHECK(loops > 5);
}

TEST_CASE("a cut across a ligament divides the block, and there is none where material is thicker") {
  const auto [first, count] = seeds(15);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double left = random.uniform(0.02, 0.2);
    Notched block = notched_block({1, 0.6, 0.3}, 0.12, 1 - left, random.uniform(0.25, 0.35), seed);
    Complex& k = block.body.surface;
    auto borders = unfollowed_borders(k, 1, k.extent(), {});
    REQUIRE(borders.size() == 1);
    REQUIRE_FALSE(borders[0].closed);
    CHECK(across_ligament(k, borders[0], left * random.uniform(0.1, 0.95)).empty());
    const auto next = across_ligament(k, borders[0], left * random.uniform(1.05, 3));
    REQUIRE(next.size() == borders[0].points.size());
    CHECK(find_pieces(k).count == 1);
    advance(k, borders[0], next);
    const Pieces pieces = find_pieces(k);
    CHECK(pieces.count == 2);
    CHECK(pieces.volume[0] + pieces.volume[1] == Approx(0.18));
  }
}

TEST_CASE("material ahead of a tip is a ligament where its surface is within half a spacing") {
  const Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.5));
  const auto [first, count] = seeds(500);
  std::size_t thin = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TipFrame tip;
    tip.at = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
    tip.ahead = random.direction();
    tip.normal = tip.ahead.unitOrthogonal();
    double ahead = 1e300;  // to the faces of the cube
    for (int axis = 0; axis < 3; ++axis)
      if (tip.ahead[axis] != 0)
        ahead = std::min(ahead, ((tip.ahead[axis] > 0 ? 1 : 0) - tip.at[axis]) / tip.ahead[axis]);
    const double spacing = random.uniform(0.1, 1);
    CHECK(is_ligament(k, tip, spacing) == (ahead < 0.5 * spacing));
    thin += ahead < 0.5 * spacing;
  }
  CHECK(8 * thin > static_cast<std::size_t>(count));
  CHECK(thin < static_cast<std::size_t>(count));
}
