// Supports of material points: which nodes a point sees.
#include "mechanics/discretisation/point_supports.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"

using namespace geo;

namespace {

struct Supported {
  MaterialPoint point;
  ShapeGradients shape;
};

std::vector<Supported> supports(const Body& body, const std::vector<Vec3>& positions,
                                const Occluders* occluders = nullptr, std::span<const std::uint32_t> component = {}) {
  std::vector<Supported> all(positions.size());
  std::vector<SupportTask> tasks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].point.position = positions[i];
    tasks.push_back({&all[i].point, &all[i].shape});
  }
  compute_supports(body, tasks, occluders, nullptr, component);
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
      if (const double d = (body.nodes.position[j] - positions[i]).norm(); d < factor * body.nodes.radius[j]) {
        expected.push_back(j);
        farthest = std::max(farthest, d);
      }
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

TEST_CASE("components of the graph, and faces nearby alone, leave the supports of points as they are", "[supports]") {
  std::size_t few = 0, bent = 0, singular = 0;
  const auto [first, count] = seeds(30);
  for (int n = 0; n < count; ++n) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(n);
    INFO("seed " << seed);
    Random random(seed);
    Body body = block_body({1, 1, 1}, 0.25);
    if (n % 2 == 0) body.resample_limit = 0;
    // Slabs, some of them with few nodes, and cuts that end within the block.
    for (int cut = 1; cut <= 6; ++cut) {
      const double x = random.uniform(0.02, 0.98), tilt = random.uniform(-0.1, 0.1);
      const Vec3 a(x, -0.2, 1.1), b(x + tilt, 1.2, 1.1), step(random.uniform(-0.05, 0.05), 0, -0.31);
      auto front = begin_front(blade_at(a, b, step, 0, 5), false, cut);
      const int steps = random.uniform(0, 1) < 0.6 ? 4 : 2;
      for (int k = 1; k <= steps; ++k) split(body, front, blade_at(a, b, step, k, 5));
    }
    std::vector<std::uint32_t> component;
    const std::uint32_t components = body.graph.components(component);
    for (std::uint32_t c = 0; c < components; ++c) few += std::count(component.begin(), component.end(), c) < 8;
    const auto positions = random_positions(random, 200);
    const Occluders everything = all_occluders(body.surface);
    const auto expected = supports(body, positions, &everything), found = supports(body, positions, nullptr, component);
    std::vector<MaterialPoint> points;
    std::vector<ShapeGradients> shapes;
    for (const Supported& e : expected) {
      points.push_back(e.point);
      shapes.push_back(e.shape);
    }
    const PointBlock block(points, shapes);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto &e = expected[i], &f = found[i];
      if (ShapeGradients again; e.point.quality != MomentQuality::singular) {
        const bool is_straight = straight_shape(body, block, i, again);
        CHECK(is_straight == (std::count(e.shape.bent.begin(), e.shape.bent.end(), 1) == 0));
        CHECK((!is_straight || (again.nodes == e.shape.nodes && again.gradient == e.shape.gradient)));
      }
      CHECK(f.shape.nodes == e.shape.nodes);
      CHECK(f.shape.gradient == e.shape.gradient);
      CHECK(f.shape.bent == e.shape.bent);
      CHECK(f.point.quality == e.point.quality);
      CHECK(f.point.widenings == e.point.widenings);
      CHECK(f.point.occluded == e.point.occluded);
      CHECK(f.point.influence_radius == e.point.influence_radius);
      bent += std::count(e.shape.bent.begin(), e.shape.bent.end(), 1) > 0;
      singular += e.point.quality == MomentQuality::singular;
    }
  }
  if (count < 30) return;
  CHECK(few > 10);
  CHECK(bent > 300);
  CHECK(singular > 30);
}
