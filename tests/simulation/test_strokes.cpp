// Strokes as a hand makes them: an edge comes from air, passes a body and leaves it, in few steps
// or many.
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

struct Strokes {
  TriangleMesh mesh;
  Scene scene;
  int frames = 0;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    Vec3 v;
    do v = {normal(engine_), normal(engine_), normal(engine_)};
    while (v.norm() < 1e-3);
    return v.normalized();
  }

 private:
  std::mt19937_64 engine_;
};

// An edge of four times the model's radius passes its middle, or near it, and turns on the way. In
// each step it goes on by another length, and it rests in some, as a pointer does. From `time` on.
Blade random_blade(Random& random, const Vec3& center, double radius, double time, double dt) {
  Blade blade;
  blade.name = "stroke";
  const int parts = static_cast<int>(random.between(4, 24));
  for (int i = 0; i <= parts; ++i) blade.points.push_back({0, 0, 2 * radius * (2.0 * i / parts - 1)});
  const Vec3 along = random.direction(), way = along.cross(random.direction()).normalized();
  const Vec3 pass = center + random.between(-0.3, 0.3) * radius * along.cross(way);
  const Mat3 frame = (Mat3() << way, along.cross(way), along).finished();
  const Vec3 axis = random.direction();
  const double turn = random.between(0, 0.6), step = radius * random.between(0.05, 0.5);
  for (double at = -1.5 * radius; at < 1.5 * radius; time += dt) {
    const Eigen::AngleAxisd pose(Eigen::AngleAxisd(turn * at / (3 * radius), axis) * Eigen::Quaterniond(frame));
    const double degrees = pose.angle() * 180 / std::numbers::pi;
    blade.motion.keys.push_back({.time = time, .position = pass + at * way, .axis = pose.axis(), .angle = degrees});
    if (random.between(0, 1) < 0.7) at += step * random.between(0.2, 1.5);
  }
  Motion::Key last = blade.motion.keys.back();
  last.time = time;
  last.position = pass + 1.6 * radius * way;
  blade.motion.keys.push_back(last);
  return blade;
}

Strokes random_strokes(std::uint64_t seed, int count) {
  Random random(seed);
  Strokes s;
  const int shape = static_cast<int>(seed % 3);
  if (shape == 0) s.mesh = make_block({1, 1, 1}, 1);
  if (shape == 1) s.mesh = make_block({random.between(0.3, 1), 1, random.between(0.5, 1.5)}, 0.25);
  if (shape == 2) s.mesh = make_sphere(6);
  const Vec3 center = bounding_box(s.mesh).center();
  double radius = 0;
  for (const Vec3& p : s.mesh.vertices) radius = std::max(radius, (p - center).norm());
  s.scene.gravity = Vec3::Zero();
  s.scene.bodies.resize(1);
  s.scene.bodies[0].sampling.count = static_cast<std::size_t>(random.between(150, 600));
  s.scene.material = {.young = 1e6, .poisson = 0.35, .density = 1000, .damping = 1.5};
  s.scene.dt = 1.0 / 60;
  s.scene.frame_rate = 60;
  double time = 0;
  for (int i = 0; i < count; ++i) {
    s.scene.blades.push_back(random_blade(random, center, radius, time, s.scene.dt));
    time = s.scene.blades.back().motion.keys.back().time + s.scene.dt;
  }
  s.frames = static_cast<int>(std::lround(time / s.scene.dt)) + 1;
  return s;
}

struct Outcome {
  std::size_t pieces = 0, crumbs = 0;
};

// Runs the strokes, and checks what they leave.
Outcome outcome_of(const Strokes& s) {
  Simulation sim(s.scene, s.mesh);
  FrameStats work;
  for (int f = 0; f < s.frames; ++f) work += sim.advance_frame();
  CHECK(work.refused == 0);
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  return {static_cast<std::size_t>(find_pieces(sim.body().surface).count), work.sheet.crumbs};
}

}  // namespace

TEST_CASE("a stroke through a body parts it, at any speed", "[strokes]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("seed " << seed);
    const Outcome outcome = outcome_of(random_strokes(seed, 1));
    CHECK(outcome.pieces == 2);
    CHECK(outcome.crumbs == 0);
  }
}

TEST_CASE("each stroke through a body that is cut parts it on", "[strokes][many]") {
  const auto [first, count] = seeds(3);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("seed " << seed);
    CHECK(outcome_of(random_strokes(seed, 3)).pieces >= 4);  // strokes near each other leave crumbs, too
  }
}
