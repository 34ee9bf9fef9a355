// Bodies that break along cells of their own, and the energy that new surfaces take.
#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "kerf/contact.h"
#include "kerf/files.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/bond_breaking.h"
#include "simulation/cohesive_walls.h"

using namespace geo;

namespace {

constexpr double young = 1e7, strength = 1e4, toughness = 2e4;

// A bar along z that is pulled apart by its ends, 1 mm in a step, with a wall across its middle. In
// steps of half a second the bar is at rest.
Scene pulled_bar() {
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.125;
  scene.material = {.young = young, .poisson = 0, .density = 1000};
  scene.gravity = Vec3::Zero();
  Grip moving{.lo = {-1, -1, 1.85}, .hi = {1, 1, 3}};
  moving.motion.keys = {{.time = 0, .position = Vec3::Zero()}, {.time = 100, .position = {0, 0, 0.2}}};
  scene.grips = {{.lo = {-1, -1, -1}, .hi = {1, 1, 0.15}}, moving};
  scene.frame_rate = 2;
  scene.dt = 0.5;
  scene.accuracy = 1e-5;
  const Front wall{.name = "wall", .steps = {{{-9, -9, 1}, {9, -9, 1}, {0, 18, 1}}}, .triangles = {{0, 1, 2}}};
  scene.scores = {{.front = wall, .glue = Strength{.strength = strength, .toughness = toughness, .variation = 0}}};
  return scene;
}

// A model that falls on the ground, and breaks along cells.
Scene thrown(double speed, double dt, std::uint64_t seed) {
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.count = 400;
  scene.bodies[0].velocity = {0.1 * speed, 0, -speed};
  scene.material = {.young = 3e6, .density = 600, .damping = 1};
  scene.ground = true;
  scene.ground_point = {0, 0, -1.1};
  scene.frame_rate = 120;
  scene.dt = dt;
  scene.seed = seed;
  scene.fracture.on = true;
  scene.fracture.cells = 30;
  scene.fracture.strength = 3e4;
  scene.fracture.seed = seed;
  return scene;
}

// Pieces at the end.
std::uint32_t pieces_of(const Scene& scene, const TriangleMesh& mesh, int frames) {
  Simulation sim(scene, mesh);
  for (int i = 0; i < frames; ++i) sim.advance_frame();
  CHECK(count_crossings(sim.surface()) == 0);
  CHECK(sim.state().total.sheet.crumbs == 0);
  const Pieces pieces = find_pieces(sim.body().surface);
  for (const double v : pieces.volume) CHECK(v > 0);
  return pieces.count;
}

}  // namespace

TEST_CASE("the cohesive law has its peak, its end and its energy, and is the derivative of its potential", "[cells]") {
  Random random(seeds(1).first);
  for (int k = 0; k < 2000; ++k) {
    const CohesiveLaw law{.peak = random.uniform(1, 10), .opening = random.uniform(0.1, 2)};
    const double reached = random.uniform(law.first(), 1.2 * law.opening), delta = random.uniform(0, 1.5 * law.opening);
    const double step = 1e-6 * law.opening;
    const double slope = (law.energy(delta + step, reached) - law.energy(delta - step, reached)) / (2 * step);
    INFO("peak " << law.peak << ", opening " << law.opening << ", reached " << reached << ", delta " << delta);
    CHECK(law.secant(delta, reached) * delta == Approx(slope).margin(1e-5 * law.peak));
    CHECK(law.spent(law.first()) == 0);
    CHECK(law.spent(2 * law.opening) == Approx(0.5 * law.peak * law.opening));
    CHECK(law.traction(law.first()) == Approx(law.peak));
    CHECK(law.traction(1.1 * law.opening) == 0);
  }
}

TEST_CASE("a bar that is pulled apart spends the energy of its toughness, and no more", "[cells]") {
  Simulation sim(pulled_bar(), make_block({0.5, 0.5, 2}, 0.25));
  const double energy = toughness * toughness / young, area = 0.25, opening = 2 * energy / strength;
  double spent = 0, stress = 0;
  for (int i = 0; i < 24; ++i) {
    const FrameStats stats = sim.advance_frame();
    spent += stats.fracture.spent;
    REQUIRE(stats.refused == 0);
    // Material in the grips is not strained.
    const double length = 1.7, elongation = 0.001 * (i + 1);
    stress = std::sqrt(2 * stats.energy * young / (area * length));
    INFO("frame " << i << ", stress " << stress << ", spent " << spent);
    if (!sim.state().glued.bonds[0].broken) {
      CHECK(stress == Approx(young * elongation / length).epsilon(0.05));
      CHECK(spent == 0);
    } else {
      CHECK(stress < 1.1 * strength);
    }
    if (elongation < 0.9 * opening) CHECK(spent < 0.95 * energy * area);
  }
  CHECK(stress < 0.01 * strength);
  CHECK(sim.state().glued.bonds[0].broken);
  CHECK(spent == Approx(energy * area).epsilon(0.01));
  CHECK_FALSE(sim.state().glued.bonds[0].cohesion.holds());
}

TEST_CASE("pieces that hang together by less than a node's share of area part", "[cells]") {
  // Three cells in a row and one beside them; areas of the bonds between them.
  GluedBonds glued;
  const auto bond = [&](std::uint32_t a, std::uint32_t b, double area) {
    const auto first = static_cast<std::uint32_t>(glued.points.size());
    if (first == 0) glued.points.assign(20, Vec3::Zero());
    // All walls meet in the edge of the points 0 and 1.
    glued.bonds.push_back({.faces = {{0, 1, 2 + static_cast<std::uint32_t>(glued.bonds.size())}},
                           .a = a,
                           .b = b,
                           .area = area,
                           .strength = 1});
  };
  bond(0, 1, 0.1);
  bond(1, 2, 3);
  bond(2, 3, 0.6);
  bond(1, 3, 0.6);
  bond(4, 0, 0.2);
  const BondBreaking breaking(glued);
  CHECK(breaking.ligaments(glued, 1).empty());  // nothing is broken yet
  glued.bonds[4].broken = true;
  CHECK(breaking.ligaments(glued, 1) == std::vector<std::uint32_t>{0});
  CHECK(breaking.ligaments(glued, 0.1).empty());
  // Two bonds of 0.6 join cell 3 with the group of 1 and 2.
  CHECK(breaking.ligaments(glued, 1.3) == std::vector<std::uint32_t>{0, 2, 3});
}

TEST_CASE("cells fill the body, and none is smaller than the material of a node", "[cells]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    Scene scene = thrown(0, 1.0 / 120, seed);
    scene.gravity = Vec3::Zero();
    scene.fracture.cells = 10 + static_cast<int>(seed % 3) * 40;
    scene.fracture.jagged = seed % 2 == 0 ? 0.01 : 0;
    Simulation sim(scene, make_sphere(6));
    INFO("KERF_CASE=" << seed);
    CHECK(find_pieces(sim.body().surface).count == 1);
    // All walls as one sheet divide the body into the cells.
    const GluedBonds& glued = sim.state().glued;
    std::vector<std::uint32_t> all(glued.bonds.size());
    for (std::uint32_t b = 0; b < all.size(); ++b) {
      all[b] = b;
      CHECK(glued.bonds[b].toughness > 0);
    }
    Complex broken = sim.body().surface;
    insert_sheet(broken, sheet_of(glued, all), 7);
    const Pieces cells = find_pieces(broken);
    const double node = std::pow(sim.body().finest_spacing, 3);
    CHECK(cells.count > 5);
    CHECK(cells.count <= static_cast<std::uint32_t>(2 * scene.fracture.cells));
    for (const double v : cells.volume) CHECK(v >= node);
  }
}

TEST_CASE("harder impacts give more pieces, and shorter steps give as many", "[cells]") {
  const TriangleMesh ball = make_sphere(8);
  const std::uint32_t slow = pieces_of(thrown(2, 1.0 / 120, 3), ball, 12),
                      middle = pieces_of(thrown(7, 1.0 / 120, 3), ball, 8),
                      fast = pieces_of(thrown(20, 1.0 / 120, 3), ball, 6);
  CAPTURE(slow, middle, fast);
  CHECK(slow <= 2);
  CHECK(middle > 5);
  CHECK(fast >= middle);
  for (const double dt : {1.0 / 240, 1.0 / 480}) {
    const std::uint32_t finer = pieces_of(thrown(7, dt, 3), ball, 8);
    CAPTURE(dt, finer);
    CHECK(finer >= 0.7 * middle);
    CHECK(finer <= 1.4 * middle);
  }
}

TEST_CASE("a scene names the cells of bodies, and is written so", "[cells]") {
  const Scene scene = parse_scene(
      "[fracture]\ncells = 40\nstrength = 3e6\njagged = 0.02\n[[body]]\nmesh = 'a.ply'\n"
      "[[body]]\nmesh = 'b.ply'\n[body.fracture]\ncells = 0\n",
      "s.toml");
  REQUIRE(scene.fracture.per_body.size() == 2);
  CHECK(scene.fracture.of_body(0).cells == 40);
  CHECK(scene.fracture.of_body(0).jagged == 0.02);
  CHECK(scene.fracture.of_body(1).cells == 0);
  CHECK(scene.fracture.of_body(1).strength == 3e6);
  CHECK(scene.fracture.any_fronts());
  std::ostringstream text;
  write_scene(text, scene, {});
  const Scene again = parse_scene(text.str(), "s.toml");
  CHECK(again.fracture.per_body == scene.fracture.per_body);
  CHECK(again.fracture.cells == 40);
}
