// Supports of material points: which nodes a point sees.
#include "mechanics/discretisation/point_supports.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "mechanics/bodies.h"

using namespace geo;

namespace {

struct Supported {
  MaterialPoint point;
  ShapeGradients shape;
};

std::vector<Supported> supports(const Body& body, const std::vector<Vec3>& positions,
                                const Occluders* occluders = nullptr) {
  std::vector<Supported> all(positions.size());
  std::vector<SupportTask> tasks;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].point.position = positions[i], tasks.push_back({&all[i].point, &all[i].shape});
  compute_supports(body, tasks, occluders);
  return all;
}

std::vector<Vec3> random_positions(Random& random, int count) {
  std::vector<Vec3> x;
  for (int i = 0; i < count; ++i)
    x.push_back({random.uniform(0.05, 0.95), random.uniform(0.05, 0.95), random.uniform(0.05, 0.95)});
  return x;
}

}  // namespace

TEST_CASE("without cracks a point's nodes are those whose support holds it", "[supports]") {
  const Body body = block_body({1, 1, 1}, 0.15);
  Random random(1);
  const auto positions = random_positions(random, 40);
  const Occluders occluders = all_occluders(body.surface);
  const auto near = supports(body, positions), all = supports(body, positions, &occluders);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double factor = support_factors[near[i].point.widenings];
    std::vector<std::uint32_t> expected;
    double farthest = 0;
    for (std::uint32_t j = 0; j < body.nodes.size(); ++j)
      if (const double d = (body.nodes.position[j] - positions[i]).norm(); d < factor * body.nodes.radius[j])
        expected.push_back(j), farthest = std::max(farthest, d);
    CHECK(near[i].shape.nodes == expected);
    CHECK(near[i].point.influence_radius >= farthest);
    CHECK(near[i].point.quality == MomentQuality::good);
    CHECK_FALSE(near[i].point.occluded);
    CHECK(all[i].shape.nodes == near[i].shape.nodes);
    CHECK(all[i].shape.gradient == near[i].shape.gradient);
    Mat3 linear = Mat3::Zero();
    for (std::size_t q = 0; q < expected.size(); ++q)
      linear += body.nodes.position[expected[q]] * near[i].shape.gradient[q].transpose();
    CHECK((linear - Mat3::Identity()).norm() < 1e-9);
  }
}

TEST_CASE("a crack through the body hides the nodes behind it, and a point on a face moves off it", "[supports]") {
  Body body = block_body({1, 1, 1}, 0.2);
  auto front = begin_front(blade_at({0.5, -0.2, 1.1}, {0.5, 1.2, 1.1}, {0, 0, -0.3}, 0, 5), false, 1);
  for (int k = 1; k <= 5; ++k) split(body, front, blade_at({0.5, -0.2, 1.1}, {0.5, 1.2, 1.1}, {0, 0, -0.3}, k, 5));
  Random random(2);
  const auto positions = random_positions(random, 40);
  std::size_t occluded = 0;
  for (const auto& [point, shape] : supports(body, positions)) {
    occluded += point.occluded;
    for (const auto j : shape.nodes) CHECK((body.nodes.position[j].x() < 0.5) == (point.position.x() < 0.5));
  }
  CHECK(occluded > 0);
  const Vec3 inside(0.3, 0.5, 0.5), on_crack(0.5, 0.5, 0.5);
  CHECK(moved_off_faces(body, inside) == inside);
  const Vec3 moved = moved_off_faces(body, on_crack);
  CHECK(moved.x() != 0.5);
  CHECK((moved - on_crack).norm() < 0.1);
}

TEST_CASE("points beside a crack have no steep shape functions while their support can be widened", "[supports]") {
  constexpr std::uint64_t first = 1, count = 40;
  std::size_t steep = 0, widest = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    Body body = block_body({1, 1, 1}, 0.2);
    const double x = random.uniform(0.3, 0.7), tilt = random.uniform(-0.2, 0.2);
    const Vec3 a(x, -0.2, 1.1), b(x + tilt, 1.2, 1.1), step(0, 0, -random.uniform(0.1, 0.4));
    auto front = begin_front(blade_at(a, b, step, 0, 5), false, 1);
    for (int k = 1; k <= 2; ++k) split(body, front, blade_at(a, b, step, k, 5));
    for (const auto& [point, shape] : supports(body, random_positions(random, 200))) {
      if (!point.occluded || point.quality != MomentQuality::good) continue;
      double largest = 0;
      for (std::size_t q = 0; q < shape.nodes.size(); ++q)
        largest = std::max(largest, shape.gradient[q].norm() * body.nodes.radius[shape.nodes[q]]);
      const double factor = support_factors[point.widenings];
      steep += point.widenings > 0;
      if (factor < support_factors.back())
        CHECK(factor * largest <= 4 * (1 + 1e-12));
      else
        ++widest;
    }
  }
  CHECK(steep > 30);
  CHECK(widest < steep);
}
