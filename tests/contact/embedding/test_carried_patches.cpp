// Slivers that the map of the body turns over are carried by an affine map of the material.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include "base/random.h"
#include "cases.h"
#include "contact/embedding/carried_patches.h"

using namespace geo;

namespace {

// Triangles in layers, disjoint at rest, of a body that bends.
struct Layers {
  ContactSurface surface;
  std::vector<Vec3> rest, given;
  std::vector<std::uint8_t> fresh, marked;
  std::vector<std::uint32_t> representative;
  Mat3 gradient = Mat3::Identity();

  UntangleInput input(double reach) const {
    return {.surface = surface,
            .rest = [this](std::uint32_t v) { return rest[v]; },
            .gradient = [this](std::uint32_t) { return gradient; },
            .fresh = fresh,
            .gap = 1e-5,
            .reach = reach};
  }
  std::vector<TrianglePair> crossings(const std::vector<Vec3>& at) const {
    return find_crossings(surface.triangles, at, representative, true);
  }
};

// Between `count` planes that are `distance` apart, each with a few triangles that overlap in no
// plane: pairs of cells of a grid, displaced by another amount in each.
Layers random_layers(Random& random, double distance, double bend) {
  constexpr int count = 4;
  Layers layers;
  const Vec3 axis = random.direction();
  const Mat3 turn = Eigen::AngleAxisd(random.uniform(0, 3), axis).toRotationMatrix();
  for (int layer = 0; layer < count; ++layer) {
    const double x = random.uniform(0, 0.5), y = random.uniform(0, 0.5);
    for (int cell = 0; cell < 4; ++cell) {
      const double left = x + (cell % 2) + 1e-3 * (cell % 2), low = y + (cell / 2) + 1e-3 * (cell / 2);
      const auto first = static_cast<std::uint32_t>(layers.rest.size());
      for (const auto& [u, v] : {std::pair{0.0, 0.0}, std::pair{1.0, 0.0}, std::pair{0.0, 1.0}})
        layers.rest.push_back({left + u, low + v, layer * distance});
      layers.surface.triangles.push_back({first, first + 1, first + 2});
    }
  }
  for (std::uint32_t v = 0; v < layers.rest.size(); ++v) {
    const Vec3& x = layers.rest[v];
    layers.given.push_back(turn * Vec3(x.x(), x.y(), x.z() + bend * x.x() * x.x()));
    layers.surface.site.push_back(v);
    layers.representative.push_back(v);
  }
  layers.gradient = turn;
  layers.fresh.assign(layers.surface.triangles.size(), 1);
  layers.marked = layers.fresh;
  return layers;
}

}  // namespace

TEST_CASE("slivers thinner than a body bends by are carried with the material", "[untangle]") {
  int tangled = 0;
  const Seeds all = seeds(2000);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double bend = random.uniform(1e-4, 1e-2);
    const Layers layers = random_layers(random, 1e-7, bend);
    REQUIRE(layers.crossings(layers.rest).empty());
    const std::vector<TrianglePair> crossings = layers.crossings(layers.given);
    if (crossings.empty()) continue;
    ++tangled;
    const UntangleInput input = layers.input(0.05);
    const CrossedSurface crossed{
        .in = input, .representative = layers.representative, .given = layers.given, .crossings = crossings};
    const auto result = carry_patches(crossed, layers.marked);
    REQUIRE(result);
    CHECK(layers.crossings(result->positions).empty());
    // No farther than a body of this size bends by.
    for (std::size_t v = 0; v < layers.given.size(); ++v)
      CHECK((result->positions[v] - layers.given[v]).norm() < 5 * bend);
  }
  CHECK(2 * tangled > all.count);
}

TEST_CASE("what would have to move too far is not carried", "[untangle]") {
  Random random(1);
  const Layers layers = random_layers(random, 1e-7, 0.1);
  const std::vector<TrianglePair> crossings = layers.crossings(layers.given);
  REQUIRE(!crossings.empty());
  const UntangleInput input = layers.input(1e-4);
  const CrossedSurface crossed{
      .in = input, .representative = layers.representative, .given = layers.given, .crossings = crossings};
  CHECK(!carry_patches(crossed, layers.marked));
}

TEST_CASE("triangles of carried vertices are marked", "[untangle]") {
  Random random(2);
  Layers layers = random_layers(random, 1e-7, 1e-3);
  layers.marked.assign(layers.marked.size(), 0);
  const std::vector<TrianglePair> crossings = layers.crossings(layers.given);
  REQUIRE(!crossings.empty());
  const UntangleInput input = layers.input(0.05);
  const CrossedSurface crossed{
      .in = input, .representative = layers.representative, .given = layers.given, .crossings = crossings};
  const auto result = carry_patches(crossed, layers.marked);
  REQUIRE(result);
  for (std::size_t t = 0; t < layers.surface.triangles.size(); ++t) {
    bool moved = false;
    for (const std::uint32_t v : layers.surface.triangles[t]) moved |= result->positions[v] != layers.given[v];
    CHECK(bool(result->marked[t]) == moved);
  }
}
