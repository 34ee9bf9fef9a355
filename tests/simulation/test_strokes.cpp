// Strokes as a hand makes them: an edge that comes from air, passes a body and leaves it, in few steps or many.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include "cases.h"
#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"

using namespace geo;

namespace {

struct Stroke {
  TriangleMesh mesh;
  Scene scene;
  int frames = 0;
};

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vec3 v;
  do v = {normal(random), normal(random), normal(random)};
  while (v.norm() < 1e-3);
  return v.normalized();
}

// An edge of twice the model's diagonal passes its middle, or near it, and turns on the way. In each
// step it goes on by another length, and it rests in some, as a pointer does.
Stroke random_stroke(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  Stroke s;
  const int shape = static_cast<int>(seed % 3);
  if (shape == 0) s.mesh = make_block({1, 1, 1}, 1);
  if (shape == 1) s.mesh = make_block({uniform(0.3, 1), 1, uniform(0.5, 1.5)}, 0.25);
  if (shape == 2) s.mesh = make_sphere(6);
  Box3 box;
  for (const Vec3& p : s.mesh.vertices) box.add(p);
  const Vec3 center = 0.5 * (box.lo + box.hi);
  double radius = 0;
  for (const Vec3& p : s.mesh.vertices) radius = std::max(radius, (p - center).norm());
  s.scene.gravity = Vec3::Zero();
  s.scene.bodies.resize(1);
  s.scene.bodies[0].sampling.count = static_cast<int>(uniform(150, 600));
  s.scene.material = {.young = 1e6, .poisson = 0.35, .density = 1000, .damping = 1.5};
  s.scene.dt = 1.0 / 60;
  s.scene.frame_rate = 60;
  Blade blade{.name = "stroke"};
  const int parts = static_cast<int>(uniform(4, 24));
  for (int i = 0; i <= parts; ++i) blade.points.push_back({0, 0, 2 * radius * (2.0 * i / parts - 1)});
  const Vec3 along = random_direction(random), way = along.cross(random_direction(random)).normalized();
  const Vec3 pass = center + uniform(-0.3, 0.3) * radius * along.cross(way);
  const Mat3 frame = (Mat3() << way, along.cross(way), along).finished();
  const Vec3 axis = random_direction(random);
  const double turn = uniform(0, 0.6), step = radius * uniform(0.05, 0.5);
  double at = -1.5 * radius, time = 0;
  while (at < 1.5 * radius) {
    const double angle = turn * at / (3 * radius);
    const Eigen::AngleAxisd pose(Eigen::AngleAxisd(angle, axis) * Eigen::Quaterniond(frame));
    blade.motion.keys.push_back({.time = time,
                                 .position = pass + at * way,
                                 .axis = pose.axis(),
                                 .angle = pose.angle() * 180 / std::numbers::pi});
    time += 1.0 / 60;
    if (uniform(0, 1) < 0.7) at += step * uniform(0.2, 1.5);
  }
  Motion::Key last = blade.motion.keys.back();
  last.time = time;
  last.position = pass + 1.6 * radius * way;
  blade.motion.keys.push_back(last);
  s.scene.blades.push_back(blade);
  s.frames = static_cast<int>(blade.motion.keys.size()) + 2;
  return s;
}

}  // namespace

TEST_CASE("a stroke through a body parts it, at any speed", "[strokes]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("seed " << seed);
    const Stroke s = random_stroke(seed);
    Simulation sim(s.scene, s.mesh);
    FrameStats work;
    for (int f = 0; f < s.frames; ++f) work += sim.advance_frame();
    CHECK(work.refused == 0);
    CHECK(find_pieces(sim.body().surface).count == 2);
    CHECK(work.sheet.crumbs == 0);
    CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  }
}
