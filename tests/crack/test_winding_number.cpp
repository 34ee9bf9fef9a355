// The generalized winding number with dipoles, beside the sum over all triangles.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "crack/winding_number.h"
#include "kerf/mesh.h"

using namespace geo;
using crack::WindingNumber;

TEST_CASE("dipoles change the winding number little, and the side of a half never") {
  const auto [first, count] = seeds(40);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    // Balls that overlap, with holes and displaced vertices; one on its own has no holes.
    TriangleMesh mesh;
    const auto balls = 1 + random.below(5);
    for (std::uint32_t b = 0; b < balls; ++b) {
      TriangleMesh ball = make_sphere(6);
      const Vec3 to = 1.5 * random.uniform() * random.direction();
      for (Vec3& p : ball.vertices) p = p * random.uniform(0.95, 1.0) + to;
      const auto at = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), ball.vertices.begin(), ball.vertices.end());
      for (const auto& [i, j, k] : ball.triangles)
        if (balls == 1 || random.uniform() > 0.1) mesh.triangles.push_back({at + i, at + j, at + k});
    }
    const WindingNumber winding(corners_of(mesh));
    for (int i = 0; i < 200; ++i) {
      const Vec3 at = 3 * random.uniform() * random.direction();
      const double exact = winding.value(at, 0);
      CHECK(std::abs(winding.value(at, 4) - exact) < 0.1);
      CHECK(winding.exceeds_half(at) == (exact > 0.5));
      if (balls == 1) CHECK(std::abs(exact - std::round(exact)) < 1e-9);
      if (balls == 1 && at.norm() < 0.2) CHECK(std::round(exact) == std::round(winding.value(at, 4)));
    }
  }
}

TEST_CASE("no triangles wind around nothing") {
  CHECK(WindingNumber({}).value({1, 2, 3}, 4) == 0);
  CHECK_FALSE(WindingNumber({}).exceeds_half({0, 0, 0}));
}
