// Glued scores in a run: bonds break at their strength, and whatever breaks keeps every invariant.
#include <catch2/catch.hpp>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/files.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "simulation/bond_breaking.h"
#include "simulation/bond_loads.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

// A plane across all bodies.
Front plane_at(const Vec3& point, const Vec3& normal) {
  const Vec3 u = 10 * normal.unitOrthogonal(), v = normal.normalized().cross(u);
  return {.name = "wall",
          .steps = {{point - u - v, point + u - v, point + u + v, point - u + v}},
          .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

// A bar that hangs at its upper end. Steps of half a second are static ones: backward Euler damps
// waves, whose periods are some hundredths of a second.
Scene hanging_bar(double strength) {
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.125;
  scene.material = {.young = 1e7, .poisson = 0, .density = 1000};
  scene.gravity = {0, 0, -10};
  scene.grips = {{.lo = {-1, -1, 1.85}, .hi = {1, 1, 3}}};
  scene.frame_rate = 2;
  scene.dt = 0.5;
  scene.scores = {{.front = plane_at({0, 0, 1}, {0, 0, 1}), .glue = Strength{.strength = strength, .variation = 0}}};
  return scene;
}

const TriangleMesh& bar() {
  static const TriangleMesh mesh = make_block({0.5, 0.5, 2}, 0.25);
  return mesh;
}

// A beam along x that is clamped at its end, with a wall across it.
Scene clamped_beam() {
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.0625;
  scene.material = {.young = 1e9, .poisson = 0, .density = 1000};
  scene.gravity = {0, 0, -1};
  scene.grips = {{.lo = {-1, -1, -1}, .hi = {0.25, 1, 1}}};
  scene.frame_rate = 2;
  scene.dt = 0.5;
  scene.accuracy = 1e-6;
  scene.scores = {{.front = plane_at({0.75, 0, 0}, {1, 0, 0}), .glue = Strength{.strength = 1e15, .variation = 0}}};
  return scene;
}

BondLoad load_after(const Scene& scene, const TriangleMesh& mesh, int frames) {
  Simulation sim(scene, mesh);
  for (int i = 0; i < frames; ++i) sim.advance_frame();
  REQUIRE(sim.state().glued.bonds.size() == 1);
  BondLoads loads;
  loads.update(sim.body(), sim.solid(), sim.state().glued);
  return loads.at(sim.solid(), sim.state().motion, sim.state().glued)[0];
}

}  // namespace

TEST_CASE("a hanging bar loads its bond by the weight below it", "[glue]") {
  const BondLoad load = load_after(hanging_bar(1e15), bar(), 4);
  const double expected = 1000 * 10 * 1.0;  // ρ g times the length below
  CHECK(load.normal == Approx(expected).epsilon(0.02));
  CHECK(load.shear < 0.02 * expected);
  CHECK(load.bending < 0.1 * expected);
}

TEST_CASE("a bond breaks at its strength, and not before", "[glue]") {
  for (const auto& [strength, broken] : {std::pair(1.1e4, false), std::pair(0.9e4, true)}) {
    Simulation sim(hanging_bar(strength), bar());
    CHECK(find_pieces(sim.body().surface).count == 1);
    FrameStats all;
    for (int i = 0; i < 4; ++i) all += sim.advance_frame();
    CHECK(all.fracture.broken == (broken ? 1 : 0));
    CHECK(all.fracture.broken_area == Approx(broken ? 0.25 : 0));
    CHECK(find_pieces(sim.body().surface).count == (broken ? 2 : 1));
    CHECK(all.refused == 0);
  }
}

TEST_CASE("the load of a bent beam is that of beam theory", "[glue]") {
  const BondLoad load = load_after(clamped_beam(), make_block({1.75, 0.25, 0.25}, 0.125), 4);
  const double per_length = 1000 * 1 * 0.0625, length = 1.0, moment = 0.5 * per_length * length * length;
  const double section = 0.25 * 0.25 * 0.25 / 6;
  CHECK(load.bending == Approx(moment / section).epsilon(0.15));
  CHECK(load.shear == Approx(per_length * length / 0.0625).epsilon(0.25));
}

TEST_CASE("pressure alone breaks nothing, and holds against shear", "[glue]") {
  const BondLoad pressed{.normal = -10, .shear = 4, .bending = 2};
  CHECK(pressed.effective(0.5) == Approx(0));
  CHECK(pressed.effective(0) == Approx(4));
  const BondLoad pulled{.normal = 3, .shear = 4, .bending = 0};
  CHECK(pulled.effective(0.5) == Approx(5));
}

TEST_CASE("a bond beside a broken one breaks at its toughness", "[glue]") {
  Complex block = Complex::from_skin(make_block({3, 1, 1}, 0.5));
  // Two walls that meet in an edge: three cells.
  TriangleMesh walls;
  walls.vertices = {{1, -1, -1},  {1, 3, -1},  {1, 3, 3},   {1, -1, 3},
                    {1, -1, 0.5}, {1, 3, 0.5}, {5, 3, 0.5}, {5, -1, 0.5}};
  walls.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  insert_sheet(block, walls, 1);
  GluedBonds glued;
  glue_crack(block, 1, glued);
  REQUIRE(glued.bonds.size() == 3);
  set_strength(glued, 0, Strength{.strength = 100, .toughness = 10, .variation = 0}, 1, 3, 0);
  const BondBreaking breaking(glued);
  for (std::uint32_t b = 0; b < 3; ++b) CHECK(breaking.limit(glued, b) == 100);
  // Both lower walls are overloaded, and share an edge: the more loaded one goes first.
  std::vector<BondLoad> loads(3);
  loads[0].normal = 120;
  loads[1].normal = 130;
  CHECK(breaking.overloaded(breaking.ratios(glued, loads, 0)) == std::vector<std::uint32_t>{1});
  glued.bonds[1].broken = true;
  const double width = std::sqrt(glued.bonds[0].area);
  CHECK(breaking.limit(glued, 0) == Approx(10 * std::sqrt(2 / (std::numbers::pi * width))));
}

namespace {

// A model with a score or with cells, thrown at the ground.
struct ThrownCase {
  Scene scene;
  TriangleMesh mesh;
};

ThrownCase thrown_case(std::uint64_t seed) {
  Random random(seed);
  ThrownCase c;
  const auto kind = random.below(3);
  c.mesh = kind == 0 ? make_block({1.2, 1, 0.8}, 0.2) : kind == 1 ? make_sphere(8) : make_pumpkin(12);
  Scene& s = c.scene;
  s.bodies.resize(1);
  s.bodies[0].sampling.count = 300 + random.below(200);
  s.bodies[0].velocity = Vec3(random.uniform(-2, 2), random.uniform(-2, 2), -random.uniform(6, 14));
  s.bodies[0].spin = 4 * random.direction();
  s.material = {.young = 3e6, .poisson = random.uniform(0.1, 0.4), .density = 600, .damping = 1};
  s.ground = true;
  s.ground_point = {0, 0, bounding_box(c.mesh).lo.z() - 0.05};
  s.frame_rate = 120;
  s.dt = 1.0 / 360;
  if (random.below(2) == 0) {
    s.fracture.on = true;
    s.fracture.cells = 8 + static_cast<int>(random.below(25));
    s.fracture.jagged = random.below(3) == 0 ? 0.01 : 0;
    s.fracture.strength = std::pow(10, random.uniform(3.8, 5.3));
    s.fracture.seed = s.seed = seed;
    return c;
  }
  ScoreOptions score;
  score.pieces = 8 + static_cast<int>(random.below(25));
  score.pattern.seed = seed;
  score.jagged.amplitude = random.below(3) == 0 ? 0.01 : 0;
  TriangleMesh walls = make_score(Complex::from_skin(c.mesh), score).sheet;
  Strength glue{.strength = std::pow(10, random.uniform(3.8, 5.3)), .variation = 0.3};
  if (random.below(2) == 0) glue.toughness = glue.strength * random.uniform(0.1, 0.6);
  s.scores = {{.front = {.name = "walls", .steps = {walls.vertices}, .triangles = walls.triangles}, .glue = glue}};
  return c;
}

}  // namespace

TEST_CASE(
    "thrown bodies break along glued walls and keep every invariant, the same with any threads and after a "
    "checkpoint",
    "[glue]") {
  const auto [first, count] = seeds(4);
  const int frames = 10;
  std::size_t broken = 0, pieces = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    const ThrownCase c = thrown_case(seed);
    set_threads(2);
    Simulation sim(c.scene, c.mesh);
    std::string half;
    std::size_t refused = 0;
    for (int i = 0; i < frames; ++i) {
      INFO("KERF_CASE=" << seed << ", frame " << i);
      const FrameStats stats = sim.advance_frame();
      broken += stats.fracture.broken;
      refused += stats.refused;
      REQUIRE(check_body(sim.body()).first_problem == "");
      REQUIRE(check_complex(sim.body().surface, SelfIntersections::find).good());
      REQUIRE(count_crossings(sim.surface()) == 0);
      if (i + 1 == frames / 2) {
        half = bytes(sim);
        sim = read_back(c.scene, half);
      }
    }
    INFO("KERF_CASE=" << seed << ", " << sim.state().glued.bonds.size() << " bonds, refused " << refused);
    const Pieces now = find_pieces(sim.body().surface);
    pieces += now.count;
    for (const double v : now.volume) CHECK(v > 0);
    set_threads(1);
    Simulation again = read_back(c.scene, half);
    for (int i = frames / 2; i < frames; ++i) again.advance_frame();
    CHECK(bytes(again) == bytes(sim));
    set_threads(0);
  }
  CHECK(broken > 20);
  CHECK(pieces > 8);
}

TEST_CASE("a scene names the strength of a score's walls, and is written so", "[glue]") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("kerf-glue-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const Front wall = plane_at({0, 0, 1}, {0, 0, 1}),
              moving{.name = "front", .steps = {{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {1, 1, 0}}}};
  for (const auto& [name, front] : {std::pair("wall.front", wall), std::pair("moving.front", moving)}) {
    std::ofstream out(folder / name);
    write_fronts(out, {front});
  }
  const auto scene_of = [&](const std::string& score) {
    return parse_scene("[body]\nmesh = 'a.ply'\n[[score]]\n" + score, "s.toml", {}, folder.string());
  };
  const Scene glued = scene_of("file = 'wall.front'\nstrength = 2e5\ntoughness = 30\nvariation = 0.1\n");
  REQUIRE(glued.scores.size() == 1);
  const Strength expected{.strength = 2e5, .toughness = 30, .variation = 0.1};
  CHECK(glued.scores[0].glue == expected);
  std::ostringstream text;
  write_scene(text, glued, folder.string());
  CHECK(parse_scene(text.str(), "s.toml", {}, folder.string()).scores[0].glue == expected);
  CHECK_FALSE(scene_of("file = 'wall.front'\n").scores[0].glue);
  CHECK_THROWS_WITH(scene_of("file = 'wall.front'\ntoughness = 30\n"), Catch::Contains("toughness"));
  CHECK_THROWS_WITH(scene_of("file = 'moving.front'\nstrength = 1\n"),
                    Catch::Contains("a front cannot be glued; give a sheet, or leave out 'strength'"));
  CHECK_FALSE(scene_of("file = 'moving.front'\n").scores[0].glue);
  fs::remove_all(folder);
}
