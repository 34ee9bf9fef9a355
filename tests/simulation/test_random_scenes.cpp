// Random scenes, as anybody may write them: models, materials, loads, strokes and steps. Nothing
// crosses, the complex stays valid, and no energy comes from nothing.
// A campaign: KERF_CASES=100 KERF_SEED=3 test_simulation "[random-scenes]"; KERF_TELL=1 tells each.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <sstream>

#include "base/random.h"
#include "cases.h"
#include "invariants/models.h"
#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"

using namespace geo;

namespace {

// Bodies that strike store energy in their contact, which no figure of a frame has, and give it
// back: up to half of all (0.53 of the largest in 200 scenes). Where energy comes from nothing,
// nearly all of the largest is the rise.
constexpr double most_stored = 0.75;
constexpr double least_energy = 1e-9;  // over the modulus, m³: scenes at rest have none but of rounding

struct RandomScene {
  TriangleMesh mesh;
  Scene scene;
  std::string about;
};

double power_of_ten(Random& random, double from, double to) { return std::pow(10.0, random.uniform(from, to)); }

// Bends a mesh by a wave that turns nothing over: its slope is below one half.
void bend(TriangleMesh& mesh, Random& random) {
  const Vec3 along = random.direction();
  const Vec3 across = along.cross(random.direction()).normalized();
  const double waves = random.uniform(1, 6);
  const double height = random.uniform(0, 0.5) / waves;
  const double phase = random.uniform(0, 2 * std::numbers::pi);
  for (Vec3& p : mesh.vertices) p += height * std::sin(waves * along.dot(p) + phase) * across;
}

// Scaled to a diagonal of 1.5 and moved to the origin.
TriangleMesh unit_large(TriangleMesh mesh) {
  const Box3 box = bounding_box(mesh);
  const double scale = 1.5 / box.diagonal();
  for (Vec3& p : mesh.vertices) p = scale * (p - box.center());
  return mesh;
}

// About a unit large: a scanned model, a block, a bar, a slab or a ball, bent, stretched and
// turned.
TriangleMesh random_model(Random& random, std::string& about) {
  const char* shapes[] = {"block", "bar", "slab", "ball", "egg", "bear", "pumpkin", "femur"};
  const std::uint32_t shape = random.below(8);
  about = shapes[shape];
  TriangleMesh mesh;
  if (shape == 0) mesh = make_block({1, 1, 1}, 1.0 / (1 + random.below(6)));
  if (shape == 1) mesh = make_block({random.uniform(1.5, 3), 0.5, 0.5}, 0.25);
  if (shape == 2) mesh = make_block({1, random.uniform(0.5, 1.5), random.uniform(0.1, 0.25)}, 0.125);
  if (shape == 3 || shape == 4) mesh = make_sphere(4 + static_cast<int>(random.below(8)));
  if (shape == 4)
    for (Vec3& p : mesh.vertices) p = p.cwiseProduct(Vec3(0.5, 0.3, 0.7));
  if (shape > 4) mesh = unit_large(invariants::model(shapes[shape]));
  if (random.below(2) == 0) {
    bend(mesh, random);
    about += ", bent";
  }
  if (random.below(2) == 0) {
    const Mat3 turned = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    for (Vec3& p : mesh.vertices) p = turned * p;
    about += ", turned";
  }
  return mesh;
}

// An edge that comes from the air, passes the model near its middle, turns on the way, and leaves
// it; or ends in it and is drawn back.
Blade random_stroke(Random& random, const Vec3& centre, double radius, double from, double until) {
  Blade blade;
  const int parts = 4 + static_cast<int>(random.below(16));
  for (int i = 0; i <= parts; ++i) blade.points.push_back({0, 0, 2 * radius * (2.0 * i / parts - 1)});
  const Vec3 along = random.direction();
  const Vec3 way = along.cross(random.direction()).normalized();
  const Vec3 pass = centre + random.uniform(-0.6, 0.6) * radius * along.cross(way);
  const Mat3 frame = (Mat3() << way, along.cross(way), along).finished();
  const Vec3 axis = random.direction();
  const double turn = random.below(2) == 0 ? 0 : random.uniform(0, 0.8);
  const bool returns = random.below(4) == 0;
  constexpr int keys = 8;
  for (int i = 0; i <= keys; ++i) {
    const double t = double(i) / keys;
    const double at = returns ? 1.5 * std::abs(2 * t - 1) - random.uniform(0, 0.1) : 1.6 - 3.2 * t;
    const Eigen::AngleAxisd pose(Eigen::AngleAxisd(turn * at, axis) * Eigen::Quaterniond(frame));
    blade.motion.keys.push_back({.time = from + t * (until - from),
                                 .position = pass + radius * at * way,
                                 .axis = pose.axis(),
                                 .angle = pose.angle() * 180 / std::numbers::pi});
  }
  return blade;
}

Material random_material(Random& random) {
  Material material;
  material.young = power_of_ten(random, 4, 7);
  material.poisson = random.uniform(0, 0.45);
  material.density = power_of_ten(random, 2, 3.5);
  if (random.below(2) == 0) material.damping = random.uniform(0, 3);
  if (random.below(3) == 0) material.viscosity = 0.01 * material.young;
  return material;
}

RandomScene random_scene(std::uint64_t seed) {
  Random random(seed);
  RandomScene result;
  result.mesh = random_model(random, result.about);
  Scene& scene = result.scene;
  scene.seed = seed;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.count = 100 + random.below(500);
  scene.material = random_material(random);
  scene.frame_rate = 30;
  const double steps[] = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240};
  scene.dt = steps[random.below(4)];
  const Box3 box = bounding_box(result.mesh);
  const double radius = 0.5 * (box.hi - box.lo).norm();
  const std::uint32_t kind = random.below(4);
  const char* kinds[] = {"floats", "spins", "hangs", "stands"};
  scene.gravity = kind < 2 ? Vec3(0, 0, 0) : Vec3(0, 0, random.uniform(-9.81, -0.5));
  if (kind == 1) scene.bodies[0].spin = random.uniform(0.5, 6) * random.direction();
  if (kind == 2) {
    const double top = box.hi.z() - random.uniform(0.1, 0.4) * (box.hi.z() - box.lo.z());
    scene.grips.push_back({.lo = {-9, -9, top}, .hi = {9, 9, 9}});
    // At rest, weight strains by a thousandth to a twentieth.
    scene.material.young = scene.material.density * -scene.gravity.z() * 2 * radius / power_of_ten(random, -3, -1.3);
  }
  if (kind == 3) {
    scene.ground = true;
    scene.ground_point = {0, 0, box.lo.z() - (random.below(2) == 0 ? 0 : random.uniform(0, 0.5))};
    scene.friction = random.uniform(0, 1);
  }
  const std::uint32_t strokes = 1 + random.below(4);
  double time = 0.03;
  for (std::uint32_t s = 0; s < strokes; ++s) {
    const double until = time + random.uniform(0.1, 0.4);
    scene.blades.push_back(random_stroke(random, box.center(), radius, time, until));
    // A hand waits between strokes, or a second edge is in the body meanwhile.
    time = random.below(5) == 0 ? time + 0.05 : until + random.uniform(0, 0.1);
  }
  scene.frames = static_cast<int>(std::ceil((time + 0.6) * scene.frame_rate));
  std::ostringstream about;
  about << result.about << ", " << kinds[kind] << ", " << scene.bodies[0].sampling.count << " nodes, E "
        << scene.material.young << ", rho " << scene.material.density << ", nu " << scene.material.poisson
        << ", step 1/" << std::lround(1 / scene.dt) << ", " << strokes << " strokes";
  result.about = about.str();
  return result;
}

struct Result {
  std::size_t crossings = 0;
  std::size_t refused = 0;
  std::size_t crumbs = 0;
  int pieces = 0;
  double rise = 0;    // of all energy above the lowest before, J
  double scale = 0;   // the largest energy that moves or strains, J
  double spread = 0;  // the largest distance of a surface vertex from the model's middle, model radii
  double seconds = 0;
};

Result run(const RandomScene& random) {
  Result result;
  Simulation sim(random.scene, random.mesh);
  FrameStats total;
  double lowest = std::numeric_limits<double>::infinity();
  for (int f = 0; f < random.scene.frames; ++f) {
    const FrameStats stats = sim.advance_frame();
    total += stats;
    result.crossings += count_crossings(sim.surface());
    const double all = stats.energy + stats.kinetic + stats.weight;
    if (std::getenv("KERF_FRAMES_TELL"))
      std::cout << f << " E " << stats.energy << " K " << stats.kinetic << " W " << stats.weight << " all " << all
                << " cut " << stats.split.crack.triangles_cut << " newton " << stats.newton << " refused "
                << stats.refused << " pieces " << find_pieces(sim.body().surface).volume.size() << " s "
                << stats.phase_seconds() << std::endl;
    REQUIRE(std::isfinite(all));
    lowest = std::min(lowest, all);
    result.rise = std::max(result.rise, all - lowest);
    result.scale = std::max({result.scale, stats.energy + stats.kinetic});
  }
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  result.refused = total.refused;
  result.crumbs = total.sheet.crumbs;
  result.pieces = static_cast<int>(find_pieces(sim.body().surface).volume.size());
  result.seconds = total.phase_seconds();
  return result;
}

}  // namespace

TEST_CASE("random scenes cross nothing and make no energy", "[random-scenes]") {
  const Seeds all = seeds(2);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    const RandomScene scene = random_scene(seed);
    INFO("KERF_CASE=" << seed << ": " << scene.about);
    const Result result = run(scene);
    if (std::getenv("KERF_TELL"))
      std::cout << seed << " " << scene.about << "\n   pieces " << result.pieces << " crumbs " << result.crumbs
                << " crossings " << result.crossings << " refused " << result.refused << " rise " << result.rise
                << " of " << result.scale << " J, " << result.seconds << " s" << std::endl;
    CHECK(result.crossings == 0);
    CHECK(result.rise < most_stored * result.scale + least_energy * scene.scene.material.young);
  }
}
