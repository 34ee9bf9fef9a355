#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/surface/surface_weights.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

TEST_CASE("after each step of a cut the weights are those of a surface looked at from scratch, to the bit",
          "[campaign]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    SampleOptions sampling;
    sampling.spacing = 0.12;
    sampling.seed = seed;
    Body body = build_body(Complex::from_skin(make_block({1, 1, 1}, 0.2)),
                           sample_nodes(make_block({1, 1, 1}, 0.2), sampling), {26, NeighborMethod::automatic});
    body.resample_limit = random.below(2) == 0 ? 0 : body.resample_limit;
    Solid solid(body, Material{});
    State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
    SurfaceWeights weights;
    weights.rebuild(body, solid);
    const double y = random.uniform(0.3, 0.7);
    auto front = begin_front(std::vector<Vec3>{{-0.3, y, 1.3}, {0.5, y + 0.01, 1.3}, {1.3, y, 1.3}}, false, 1);
    for (int step = 1; step <= 9; ++step) {
      const double z = 1.3 - 0.2 * step, sway = random.uniform(-0.05, 0.05);
      const BodyDelta delta = split(body, front, {{-0.3, y + sway, z}, {0.5, y + sway + 0.05, z}, {1.3, y + sway, z}});
      solid.update(body, delta, state);
      weights.mark_changed(body, delta);
      if (step < 9 && random.below(2) == 0) continue;  // several steps before an update
      weights.update(body, solid);
      SurfaceWeights whole;
      whole.rebuild(body, solid);
      REQUIRE(weights.size() == whole.size());
      CHECK(weights.heaviest() == whole.heaviest());
      std::size_t other = 0;
      for (std::size_t v = 0; v < whole.size(); ++v) {
        const auto a = weights.stencil(v), b = whole.stencil(v);
        other += !std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NodeWeight& p, const NodeWeight& q) {
          return p.node == q.node && p.weight == q.weight;
        });
      }
      CHECK(other == 0);
      // Many at once are what each is alone, to the bit, in any order.
      std::vector<Vec3> values;
      for (std::size_t i = 0; i < solid.size(); ++i) values.push_back(random.direction());
      std::vector<std::uint32_t> asked;
      for (std::size_t k = 0; k < whole.size() + 1; ++k)
        asked.push_back(random.below(static_cast<std::uint32_t>(whole.size())));
      const std::vector<Vec3> many = whole.interpolate(asked, values);
      std::size_t differ = 0;
      for (std::size_t k = 0; k < asked.size(); ++k) differ += many[k] != whole.interpolate(asked[k], values);
      CHECK(differ == 0);
    }
  }
}

TEST_CASE("slices and wedges follow a rotation, and no vertex amplifies the motion of its nodes", "[campaign]") {
  const Seeds all = seeds(12);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const TriangleMesh block = make_block({1, 1, 1}, 0.2);
    Body body = build_body(Complex::from_skin(block), sample_nodes(block, {.count = 200, .seed = seed}));
    // Planes at small distances and angles to the first one.
    const Vec3 normal = random.direction();
    const double height = normal.dot(Vec3(0.5, 0.5, 0.5)) + random.uniform(-0.3, 0.3);
    for (int crack = 1; crack <= 3; ++crack) {
      const Vec3 n = (normal + (crack - 1) * random.uniform(0, 0.1) * random.direction()).normalized(),
                 along = n.unitOrthogonal(), forward = n.cross(along),
                 middle = (height + (crack - 1) * random.uniform(0.005, 0.05)) * n;
      const auto edge = [&](double at) {
        return std::vector<Vec3>{middle - 2 * along + at * forward, middle + 2 * along + at * forward};
      };
      auto front = begin_front(edge(-2), false, crack);
      for (int step = 1; step <= 4; ++step) split(body, front, edge(-2 + step));
    }
    Solid solid(body, Material{});
    SurfaceWeights weights;
    weights.rebuild(body, solid);
    const Mat3 turn = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    std::vector<Vec3> u;
    for (const Vec3& x : body.nodes.position) u.push_back(turn * x - x);
    // Nodes whose neighbours do not span space take their rotation from the state.
    State state{u, std::vector<Vec3>(u.size(), Vec3::Zero())};
    state.rotation.assign(u.size(), turn);
    solid.set_rotations(state);
    weights.set_rotations(solid, u);
    double most = 0, farthest = 0;
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      if (!weights.alive(v)) continue;
      most = std::max(most, weights.norm(v));
      farthest = std::max(farthest, (weights.placed(v, weights.interpolate(v, u)) - turn * weights.rest(v)).norm());
    }
    CHECK(most <= 7 + 1e-12);
    CHECK(farthest < 1e-7);
  }
}
