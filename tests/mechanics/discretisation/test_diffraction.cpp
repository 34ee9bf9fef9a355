// Visibility round the fronts of cracks.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "mechanics/bodies.h"
#include "mechanics/discretisation/diffraction.h"

using namespace geo;

namespace {

struct Cracked {
  Body body;
  OccludingFaces faces;
  std::vector<FrontEdge> edges;
};

// A block with a cut in the plane x = 0.5 from above, down to z = 0.5 after two steps, through it
// after five.
Cracked cracked(int steps) {
  Cracked c{block_body({1, 1, 1}, 0.2), {}, {}};
  auto front = begin_front(blade_at({0.5, -0.2, 1.1}, {0.5, 1.2, 1.1}, {0, 0, -0.3}, 0, 5), false, 1);
  for (int k = 1; k <= steps; ++k)
    split(c.body, front, blade_at({0.5, -0.2, 1.1}, {0.5, 1.2, 1.1}, {0, 0, -0.3}, k, 5));
  std::vector<FaceId> alive;
  for (std::uint32_t f = 0; f < c.body.surface.face_count(); ++f)
    if (c.body.surface.alive(FaceId(f))) alive.push_back(FaceId(f));
  c.faces.update(c.body.surface, alive);
  c.edges = front_edges(c.body.surface, alive);
  return c;
}

// The node as x sees it round one of the edges.
std::optional<SupportNode> seen_round(const Vec3& x, const Vec3& node, double support, std::span<const FrontEdge> edges,
                                      const OccludingFaces& faces) {
  return diffracted_support(x, node, support, fronts_near(x, support, edges), faces);
}

}  // namespace

TEST_CASE("a crack's front is where one of its faces ends in material") {
  const Cracked c = cracked(2);
  double length = 0;
  for (const FrontEdge& e : c.edges) {
    CHECK(e.a.z() == Approx(0.5));
    CHECK((e.ahead - Vec3(0, 0, -1)).norm() < 1e-12);
    length += (e.b - e.a).norm();
  }
  CHECK(length == Approx(1));
  CHECK(cracked(5).edges.empty());
}

TEST_CASE("a node behind a crack has the diffraction distance of the shortest path round the front") {
  const Cracked c = cracked(2);
  // Unfolded about the front at z = 0.5, 0.04 and 0.03 away on either side of the crack and 0.06
  // apart along it.
  const Vec3 x(0.46, 0.47, 0.5), node(0.53, 0.53, 0.5 + 1e-9);
  const double straight = (node - x).norm(), length = std::hypot(0.07, 0.06);
  const Vec3 high(0.46, 0.47, 0.53), over(0.53, 0.53, 0.54);
  const double support = 0.4, bent_length = std::hypot(0.05 + 0.05, 0.06), high_straight = (over - high).norm();
  const auto level = seen_round(x, node, support, c.edges, c.faces),
             found = seen_round(high, over, support, c.edges, c.faces);
  REQUIRE(level);
  CHECK(level->distance == Approx(std::pow(length / straight, 4) * straight).epsilon(0.02));
  REQUIRE(found);
  CHECK(found->distance == Approx(std::pow(bent_length / high_straight, 4) * high_straight)
                               .epsilon(0.05));  // it bends a little ahead of the front
  CHECK_FALSE(seen_round(high, over, 0.99 * found->distance, c.edges, c.faces));
  CHECK_FALSE(seen_round({0.46, 0.47, 0.8}, {0.53, 0.53, 0.8}, support, c.edges, c.faces));
  for (const FrontEdge& e : c.edges) CHECK_FALSE(seen_round(high, over, support, std::span(&e, 1), cracked(5).faces));
}

TEST_CASE(
    "the gradient of a diffraction distance matches differences up to a norm of 4, and the distance is no less than "
    "the straight one") {
  const Cracked c = cracked(2);
  constexpr std::uint64_t first = 1, count = 200;
  int seen = 0, steep = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    Random random(seed);
    const auto side = [&](double sign) {
      return Vec3(0.5 + sign * random.uniform(0.01, 0.2), random.uniform(0.3, 0.7), random.uniform(0.45, 0.65));
    };
    const Vec3 x = side(-1), node = side(1);
    const double support = 0.6, step = 1e-7;
    std::uint8_t hidden = 0;
    c.faces.blocks(x, {&node, 1}, &hidden);
    if (!hidden) continue;
    const auto here = seen_round(x, node, support, c.edges, c.faces);
    if (!here) continue;
    INFO("seed " << seed);
    ++seen;
    CHECK(here->distance >= (node - x).norm());
    const Vec3 d = step * random.direction();
    const auto forward = seen_round(x + d, node, support, c.edges, c.faces),
               back = seen_round(x - d, node, support, c.edges, c.faces);
    const double norm = here->distance_gradient.norm();
    CHECK(norm < 4 + 1e-12);
    if (!forward || !back) continue;
    const double change = forward->distance - back->distance, expected = 2 * here->distance_gradient.dot(d);
    if (norm < 4 - 1e-12) {
      CHECK(change == Approx(expected).margin(1e-4 * step * norm));
    } else {  // the same direction, scaled down
      ++steep;
      CHECK(change * expected >= -1e-8 * step * step);
      CHECK(std::abs(change) >= (1 - 1e-4) * std::abs(expected) - 1e-4 * step);
    }
  }
  CHECK(seen > 50);
  CHECK(steep > 5);
}
