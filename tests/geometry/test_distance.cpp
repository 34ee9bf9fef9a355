// Closest points against dense sampling and the conditions of optimality.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"

using namespace geo;

TEST_CASE("the closest point lies on its feature, and no sample of the triangle is closer", "[distance]") {
  const auto [first, count] = seeds(60);
  int features[7] = {};
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const bool grid = random.below(3) == 0;  // degenerate triangles, ties between features
    const auto point = [&](double scale) {
      return grid ? Vec3(random.below(3), random.below(3), random.below(3)) : Vec3(scale * random.direction());
    };
    const Vec3 t[3] = {point(1), point(1), point(1)};
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = point(2);
      const auto [c, feature] = closest_on_triangle(p, t[0], t[1], t[2]);
      REQUIRE((feature >= -1 && feature < 6));
      ++features[feature + 1];
      if (feature >= 0 && feature < 3) REQUIRE(c == t[feature]);
      if (feature >= 3) REQUIRE(distance_between_segments(c, c, t[feature - 3], t[(feature - 2) % 3]) < 1e-12);
      for (int i = 0; i <= 20; ++i)
        for (int j = 0; i + j <= 20; ++j) {
          const Vec3 sample = t[0] + (i * (t[1] - t[0]) + j * (t[2] - t[0])) / 20.0;
          REQUIRE((c - p).norm() <= (sample - p).norm() + 1e-12);
        }
      const Vec3 w = barycentric(p, t[0], t[1], t[2]);
      REQUIRE(w.sum() == Approx(1).margin(1e-9));
      if (feature == -1) REQUIRE((w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - c).norm() < 1e-9);
    }
  }
  if (count >= 60)
    for (const int times : features) CHECK(times > 0);
}

TEST_CASE("the distance of segments is the least of samples, also of points and parallels", "[distance]") {
  CHECK(distance_between_segments({0, 0, 0}, {1, 0, 0}, {0.5, -1, 2}, {0.5, 1, 2}) == Approx(2));
  CHECK(distance_between_segments({0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {5, 1, 0}) == Approx(std::sqrt(2.0)));
  CHECK(distance_between_segments({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}) == Approx(5));
  const auto [first, count] = seeds(60);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const bool grid = random.below(2) == 0;
    const auto point = [&] {
      return grid ? Vec3(random.below(3), random.below(3), random.below(3)) : Vec3(random.direction());
    };
    const Vec3 p = point(), q = point(), r = point(), s = point();
    const double d = distance_between_segments(p, q, r, s);
    double sampled = 1e300;
    for (int i = 0; i <= 60; ++i)
      for (int j = 0; j <= 60; ++j)
        sampled = std::min(sampled, (p + i * (q - p) / 60.0 - r - j * (s - r) / 60.0).norm());
    REQUIRE(d <= sampled + 1e-12);
    REQUIRE(d >= sampled - 0.06);  // half the spacing of samples on both
    REQUIRE(d == Approx(distance_between_segments(r, s, p, q)).margin(1e-12));
  }
}

TEST_CASE("a bounding ball holds the corners and touches the farthest", "[distance]") {
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const std::array<Vec3, 3> t{random.direction(), random.direction(), random.direction()};
    const Ball ball = bounding_ball(t);
    double farthest = 0;
    for (const Vec3& corner : t) farthest = std::max(farthest, (corner - ball.center).norm());
    REQUIRE(farthest == Approx(ball.radius));
  }
}

TEST_CASE("barycentric coordinates of a triangle without area are those of its first corner", "[distance]") {
  CHECK(barycentric({1, 2, 3}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}) == Vec3(1, 0, 0));
}
