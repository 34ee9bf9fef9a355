// Solids in single precision: valid again after rounding, near where they were.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

bool holds_floats(const TriangleMesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) {
    return std::all_of(p.begin(), p.end(), [](double x) { return x == static_cast<double>(static_cast<float>(x)); });
  });
}

// Balls of several sizes that overlap, united, at `to`.
TriangleMesh balls(std::uint64_t seed, const Vec3& to) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < 5; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const TriangleMesh ball = make_sphere(8);
    const double size = 0.5 + random.uniform();
    const Vec3 place = random.uniform() * random.direction();
    for (const Vec3& p : ball.vertices) mesh.vertices.push_back(size * p + place);
    for (const auto& [a, b, c] : ball.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  }
  mesh = self_union(mesh);
  for (Vec3& p : mesh.vertices) p += to;
  return mesh;
}

}  // namespace

TEST_CASE("united balls far from the origin are solids of the same volume in single precision", "[rounded]") {
  const auto [first, count] = seeds(12);
  std::size_t crossed = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    // Floats are then 2⁻¹⁵ to 2⁻⁹ apart, the balls 1 in radius.
    const Vec3 to = Vec3::Constant(std::exp2(double(8 + seed % 6)));
    const TriangleMesh solid = balls(seed, to);
    if (!check_surface(solid, SelfIntersections::find).good()) continue;  // moved there, in double precision
    RoundingStats stats;
    const TriangleMesh rounded = rounded_solid(solid, &stats);
    CHECK(holds_floats(rounded));
    CHECK_NOTHROW(require_solid(rounded));
    CHECK(signed_volume(rounded) == Approx(signed_volume(solid)).epsilon(0.02));
    CHECK(crossings_in_single_precision({rounded, 0, Vec3::Zero()}) == 0);
    crossed += stats.crossings > 0;
  }
  CHECK(crossed > 0);  // else nothing was tested
}

TEST_CASE("a solid that holds floats already stays as it is", "[rounded]") {
  const TriangleMesh block = make_block({1, 2, 3}, 1);
  RoundingStats stats;
  const TriangleMesh rounded = rounded_solid(block, &stats);
  CHECK(rounded.vertices == block.vertices);
  CHECK(rounded.triangles == block.triangles);
  CHECK(stats.rounds == 0);
  CHECK(stats.crossings == 0);
}

TEST_CASE("what is thinner than the distance of floats is refused", "[rounded]") {
  TriangleMesh plate = make_block({1, 1, 1e-9}, 1);
  for (Vec3& p : plate.vertices) p.z() += 1;
  require_solid(plate);
  CHECK_THROWS(rounded_solid(plate));
}
