// Closest points of simplices, separation along a direction, and disjoint sub-simplices.
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/simplex.h"

using namespace geo;

namespace {

Vec3 random_weights(Random& random, int size) {
  Vec3 w = Vec3::Zero();
  for (int k = 0; k < size; ++k) w[k] = random.uniform();
  return w / w.sum();
}

}  // namespace

TEST_CASE("closest points are points of both simplices, and no others are closer", "[simplex]") {
  const auto [first, count] = seeds(200);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const int a_size = 1 + static_cast<int>(random.below(3)), b_size = 1 + static_cast<int>(random.below(3));
    const bool grid = random.below(2) == 0;  // parallel edges, simplices without extent
    Vec3 a[3], b[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = grid ? Vec3(random.below(3), random.below(3), random.below(3)) : Vec3(random.direction());
      b[k] =
          Vec3(2.5, 0, 0) + (grid ? Vec3(random.below(3), random.below(3), random.below(3)) : Vec3(random.direction()));
    }
    const auto flat = [](const Vec3* s, int size) {
      return size == 3 && (s[1] - s[0]).cross(s[2] - s[0]).norm() < 1e-3;
    };
    if (flat(a, a_size) || flat(b, b_size)) continue;
    const ClosestPoints c = closest_points(a, a_size, b, b_size);
    REQUIRE((c.weights_a.minCoeff() >= 0 && c.weights_b.minCoeff() >= 0));
    REQUIRE(c.weights_a.sum() == Approx(1).margin(1e-12));
    REQUIRE(c.weights_b.sum() == Approx(1).margin(1e-12));
    const auto point = [](const Vec3& w, const Vec3* s, int size) {
      Vec3 p = Vec3::Zero();
      for (int k = 0; k < size; ++k) p += w[k] * s[k];
      return p;
    };
    REQUIRE((point(c.weights_a, a, a_size) - point(c.weights_b, b, b_size) - c.difference).norm() < 1e-12);
    for (int k = 0; k < 200; ++k) {
      const Vec3 other =
          point(random_weights(random, a_size), a, a_size) - point(random_weights(random, b_size), b, b_size);
      REQUIRE(c.difference.norm() <= other.norm() + 1e-9);
    }
    // The difference of closest points separates disjoint convex sets by their distance.
    if (c.difference.norm() < 1e-6) continue;
    std::vector<Vec3> at(a, a + 3);
    at.insert(at.end(), b, b + 3);
    const Simplex first_simplex{{0, 1, 2}, a_size}, second{{3, 4, 5}, b_size};
    REQUIRE(separation_along(c.difference.normalized(), first_simplex, second, at) ==
            Approx(c.difference.norm()).margin(1e-9));
  }
}

TEST_CASE("separation is what a direction leaves between two simplices", "[simplex]") {
  const std::vector<Vec3> at{{0, 0, 2}, {5, 0, 3}, {0, 0, 1}, {9, 9, -4}};
  const Simplex a{{0, 1, 0}, 2}, b{{2, 3, 0}, 2};
  CHECK(separation_along({0, 0, 1}, a, b, at) == 1);
  CHECK(separation_along({0, 0, 2}, a, b, at) == 2);
  CHECK(separation_along({0, 0, -1}, a, b, at) == -7);
}

TEST_CASE("triangles are disjoint except for the vertices that they share", "[simplex]") {
  std::pair<Simplex, Simplex> pairs[2];
  const auto vertices = [](const Simplex& s) {
    std::vector<std::uint32_t> v(s.v, s.v + s.size);
    std::sort(v.begin(), v.end());
    return v;
  };
  using List = std::vector<std::uint32_t>;
  REQUIRE(disjoint_subsimplices({0, 1, 2}, {3, 4, 5}, pairs) == 1);
  CHECK((vertices(pairs[0].first) == List{0, 1, 2} && vertices(pairs[0].second) == List{3, 4, 5}));
  REQUIRE(disjoint_subsimplices({0, 1, 2}, {4, 2, 3}, pairs) == 2);  // a common corner: edges against triangles
  CHECK((vertices(pairs[0].first) == List{0, 1} && vertices(pairs[0].second) == List{2, 3, 4}));
  CHECK((vertices(pairs[1].first) == List{0, 1, 2} && vertices(pairs[1].second) == List{3, 4}));
  REQUIRE(disjoint_subsimplices({0, 1, 2}, {2, 1, 7}, pairs) == 2);  // a common edge: corners against triangles
  CHECK((vertices(pairs[0].first) == List{0} && vertices(pairs[0].second) == List{1, 2, 7}));
  CHECK((vertices(pairs[1].first) == List{0, 1, 2} && vertices(pairs[1].second) == List{7}));
  CHECK(disjoint_subsimplices({0, 1, 2}, {0, 2, 1}, pairs) == 0);
}
