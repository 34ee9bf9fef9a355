// Strokes of the scalpel on a surface whose normals jump, as those of triangles do.
#include <catch2/catch.hpp>

#include <vector>

#include <kerf/contact.h>
#include <kerf/mesh.h>
#include "base/random.h"
#include "cases.h"
#include "live/session.h"
#include "setup.h"

using namespace live;
using geo::Random;
using geo::Vec3;

namespace {

sim::Setup setup() {
  return setup_of(R"(
[body]
mesh = "block.ply"
spacing = 0.3
fixed = [[-1, -1, -1, 2, 2, 0.1]]
[material]
young = 1e5
damping = 20.0
)",
                  geo::make_block({1, 1, 1}, 0.25));
}

// The pose that a page sends for a point of the block's top, under a normal that is off by `jump`.
Stroke pose(Phase phase, const Vec3& point, double depth, double jump, Random& random) {
  const Vec3 normal = Vec3(random.uniform(-jump, jump), random.uniform(-jump, jump), 1).normalized();
  const double above = 0.25 * depth;
  return {1, 1, phase, point + above * normal, -normal, depth + above, above};
}

// Whether every point of an edge went forward, seen from the point that is on the surface.
bool goes_forward(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  const auto on_surface = [](const std::vector<Vec3>& edge) {
    return Vec3(edge.front() + 0.2 * (edge.back() - edge.front()));
  };
  const Vec3 direction = (before.back() - before.front()).normalized();
  Vec3 way = on_surface(after) - on_surface(before);
  way -= way.dot(direction) * direction;
  for (std::size_t i = 0; i < before.size(); ++i)
    if ((after[i] - before[i]).dot(way) < -1e-9) return false;
  return true;
}

}  // namespace

TEST_CASE("the scalpel's edge goes forward in all its points, whatever the normals do") {
  const Seeds run = seeds(6);
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Session session(setup(), {});
    const bool through = seed % 2 == 0;
    const double depth = through ? 1.6 : random.uniform(0.2, 0.5), jump = random.uniform(0.1, 0.6);
    // An edge that reaches through begins and ends so far outside that no tilt leads it inside.
    const double outside = through ? 1 : 0.15;
    const Vec3 from(-outside, random.uniform(0.35, 0.65), 1), to(1 + outside, random.uniform(0.35, 0.65), 1);
    const int steps = static_cast<int>((1 + 2 * outside) * random.uniform(12, 30));
    session.obey(1, pose(Phase::begin, from, depth, jump, random));
    std::vector<Vec3> before;
    std::size_t moved = 0, backward = 0;
    for (int i = 1; i < 200 && (i <= steps || !session.edges().empty()); ++i) {
      if (i <= steps)
        session.obey(1,
                     pose(i == steps ? Phase::end : Phase::move, from + (to - from) * i / steps, depth, jump, random));
      REQUIRE(session.advance().empty());
      if (session.edges().empty()) continue;
      const std::vector<Vec3> after = session.edges().at(0).first;
      if (!before.empty()) {
        ++moved;
        backward += !goes_forward(before, after);
      }
      before = after;
    }
    session.advance();
    CHECK(session.edges().empty());
    CHECK(moved > 5);
    CHECK(backward == 0);
    CHECK(session.pieces() == (through ? 2 : 1));
    CHECK(geo::count_crossings(session.run().surface()) == 0);
  }
}
