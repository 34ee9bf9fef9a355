// Springs, pins, blades and changed values that a run gets on its way, and the same run from a
// scene that has them from the start.
#include <catch2/catch.hpp>

#include <numeric>
#include <sstream>

#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/kept_run.h"
#include "simulation/pulls.h"
#include "simulation/scene_changes.h"

using namespace geo;

namespace {

Scene cube_scene() {
  return parse_scene(R"(
gravity = [0, 0, -2]
[body]
mesh = "cube.ply"
spacing = 0.25
[material]
young = 3e4
damping = 6.0
[time]
frame_rate = 20
step = 0.05
)",
                     "s.toml");
}

double mass_of(const Simulation& run) {
  double mass = 0;
  for (std::uint32_t i = 0; i < run.solid().size(); ++i) mass += run.solid().mass(NodeId(i));
  return mass;
}

// A spring that holds the top of the cube from the point above it.
Pull hook(double stiffness) {
  Pull pull;
  pull.point = {0.5, 0.5, 0.98};
  pull.stiffness = stiffness;
  pull.motion.keys = {{0, {0.5, 0.5, 0.98}, Vec3::UnitZ(), 0}, {100, {0.5, 0.5, 0.98}, Vec3::UnitZ(), 0}};
  return pull;
}

Vec3 place(const Simulation& run, const Pull& pull, NodeId node) {
  return pull.point +
         weighted_sum(point_weights(run.body(), run.solid(), node, pull.point), run.state().motion.displacement);
}

Pose at(const Vec3& p, double degrees) {
  return {p, Eigen::Quaterniond(Eigen::AngleAxisd(degrees / 57.29577951308232, Vec3(0.1, 0.2, 1).normalized()))};
}

// A run in which hands do everything that they can.
struct Handled {
  Scene scene;  // with all of it
  std::string bytes;
};
Handled handled(bool implicit) {
  Scene scene = cube_scene();
  scene.implicit = implicit;
  scene.ground = true;
  scene.ground_point = {0, 0, -0.1};
  scene.self_contact = implicit;
  Simulation run(scene, make_block({1, 1, 1}, 0.25));
  const auto frames = [&](int n) {
    for (int i = 0; i < n; ++i) run.advance_frame();
  };
  frames(2);
  Blade blade;
  blade.points = {{-0.4, 0, 0}, {0.5, 0, 0}, {1.4, 0, 0}};
  auto knife = run.add_blade(blade, at({0.01, 0.51, 1.2}, 2));
  Pull pull = hook(500);
  pull.motion.keys.clear();
  auto spring = run.add_pull(pull, {0.5, 0.5, 1});
  for (int i = 0; i < 5; ++i) {
    knife.drive_to(at({0.01 + 0.003 * i, 0.511 - 0.002 * i, 1.0 - 0.3 * i}, 2 + i));
    spring.drive_to({0.5, 0.5 + 0.1 * i, 1 + 0.05 * i});
    if (i == 2) {
      SceneChange change;
      change.young = 2e4;
      change.gravity = Vec3(0.3, 0, -3);
      change.friction = 0.2;
      change.damping = 1.5;
      run.change(change);
      Grip pin;
      pin.lo = {-1, -1, -1};
      pin.hi = {0.3, 0.3, 0.3};
      run.add_grip(pin);
    }
    frames(1);
  }
  run.grip(0).end();
  SceneChange change;
  change.accuracy = 5e-3;
  change.dt = 0.025;
  run.change(change);
  frames(3);
  Scene recorded = scene;
  recorded.blades = run.scene().blades;
  recorded.grips = run.scene().grips;
  recorded.pulls = run.scene().pulls;
  recorded.changes = run.scene().changes;
  return {recorded, bytes(run)};
}

}  // namespace

TEST_CASE("a body hangs on a spring that is stretched by its weight over the stiffness", "[hands]") {
  for (const bool implicit : {true, false}) {
    Scene scene = cube_scene();
    scene.implicit = implicit;
    Simulation run(scene, make_block({1, 1, 1}, 0.25));
    Pull pull = hook(8e3);
    pull.node = 0;  // replaced by the nearest, so that the point is known here
    const auto& nodes = run.body().nodes.position;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      if ((nodes[i] - pull.point).norm() < (nodes[*pull.node] - pull.point).norm()) pull.node = i;
    run.add_pull(pull);
    FrameStats stats;
    for (int i = 0; i < 160; ++i) stats = run.advance_frame();
    const double weight = 2 * mass_of(run);
    CAPTURE(implicit, weight);
    REQUIRE(stats.pull_force.size() == 1);
    CHECK((stats.pull_force[0] - Vec3(0, 0, -weight)).norm() < 0.01 * weight);
    const Vec3 stretch = place(run, pull, NodeId(*pull.node)) - pull.motion.keys[0].position;
    CHECK((8e3 * stretch - stats.pull_force[0]).norm() < 0.01 * weight);
  }
}

TEST_CASE("the weights of a point give linear fields exactly", "[hands]") {
  Simulation run(cube_scene(), make_block({1, 1, 1}, 0.25));
  const auto& nodes = run.body().nodes.position;
  const Mat3 a = (Mat3() << 1, 2, 3, -4, 5, 6, 7, 8, -9).finished();
  std::vector<Vec3> u;
  for (const Vec3& x : nodes) u.push_back(a * x + Vec3(1, 2, 3));
  for (std::uint32_t i = 0; i < nodes.size(); i += 7) {
    const Vec3 x = nodes[i] + Vec3(0.02, -0.05, 0.04);
    CHECK((weighted_sum(point_weights(run.body(), run.solid(), NodeId(i), x), u) - (a * x + Vec3(1, 2, 3))).norm() <
          1e-9);
  }
}

TEST_CASE("a pin holds its nodes where they are, from its begin to its end", "[hands]") {
  Simulation run(cube_scene(), make_block({1, 1, 1}, 0.25));
  for (int i = 0; i < 3; ++i) run.advance_frame();
  Grip pin;
  pin.lo = {-1, -1, 0.6};
  pin.hi = {2, 2, 2};
  auto grip = run.add_grip(pin);
  const auto held = [&](std::size_t i) { return run.body().nodes.position[i].z() >= 0.6; };
  const std::vector<Vec3> before = run.state().motion.displacement;
  for (int i = 0; i < 10; ++i) run.advance_frame();
  bool moved = false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (held(i)) CHECK((run.state().motion.displacement[i] - before[i]).norm() < 1e-9);
    moved |= !held(i) && run.state().motion.displacement[i] != before[i];
  }
  CHECK(moved);
  grip.end();
  run.advance_frame();
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(run.state().motion.displacement[i] != before[i]);
}

TEST_CASE("values change at their time", "[hands]") {
  Scene scene = cube_scene();
  scene.material.damping = 0;
  SceneChange change;
  change.time = 0.25;
  change.gravity = Vec3(0, 0, 2);
  scene.changes = {change};
  Simulation run(scene, make_block({1, 1, 1}, 0.25));
  for (int i = 0; i < 5; ++i) run.advance_frame();
  CHECK(run.solid().momentum(run.state().motion).z() == Approx(-2 * 0.25 * mass_of(run)));
  for (int i = 0; i < 5; ++i) run.advance_frame();
  CHECK(std::abs(run.solid().momentum(run.state().motion).z()) < 1e-6);
  CHECK(run.scene().gravity == Vec3(0, 0, 2));
  // A body's own stiffness keeps its ratio to the scene's.
  scene.bodies[0].material = scene.material;
  scene.bodies[0].material->young = 9e4;
  SceneChanges changes(scene);
  scene.changes[0].young = 6e4;
  scene.changes[0].dt = 0.01;
  CHECK_FALSE(changes.apply(scene, 0.2));
  CHECK(changes.apply(scene, 0.25));
  CHECK_FALSE(changes.apply(scene, 0.3));
  CHECK(scene.bodies[0].material->young == Approx(18e4));
  CHECK(scene.dt == 0.01);
  changes.revert(scene);
  CHECK(scene.bodies[0].material->young == 9e4);
  CHECK(scene.gravity == Vec3(0, 0, -2));
  // Softer material sags more from the change on.
  CHECK_THROWS_AS(run.change({.young = -1}), InputError);
  CHECK_THROWS_AS(run.change({.friction = 2}), InputError);
  CHECK_THROWS_AS(run.add_pull({.point = {0, 0, 0}, .node = 1000000}), InputError);
  CHECK_THROWS_AS(run.add_blade({}), InputError);
  CHECK_THROWS_AS(run.grip(7), std::out_of_range);
  CHECK_THROWS_AS(run.blade(0), std::out_of_range);
}

TEST_CASE("a run that goes back has the values of that time", "[hands]") {
  Scene scene = cube_scene();
  scene.changes = {{.time = 0.25, .young = 6e4, .gravity = Vec3(0, 0, 2)}};
  Simulation run(scene, make_block({1, 1, 1}, 0.25));
  for (int i = 0; i < 2; ++i) run.advance_frame();
  const Body body = run.body();
  const RunState state = run.state();
  for (int i = 0; i < 6; ++i) run.advance_frame();
  run.restore(Body(body), RunState(state));
  CHECK(run.scene().gravity == scene.gravity);
  Simulation other(scene, body, state);
  for (int i = 0; i < 5; ++i) {
    run.advance_frame();
    other.advance_frame();
    CHECK(bytes(run) == bytes(other));
  }
}

TEST_CASE("a change of a run goes before the scene's later ones", "[hands]") {
  Scene scene = cube_scene();
  scene.material.damping = 0;
  scene.changes = {{.time = 0.25, .gravity = Vec3(0, 0, 2)}};
  const TriangleMesh cube = make_block({1, 1, 1}, 0.25);
  Simulation run(scene, cube);
  for (int i = 0; i < 2; ++i) run.advance_frame();
  run.change({.gravity = Vec3(0, 0, -4)});
  for (int i = 0; i < 3; ++i) run.advance_frame();
  CHECK(run.solid().momentum(run.state().motion).z() == Approx(-(2 * 0.1 + 4 * 0.15) * mass_of(run)));
  for (int i = 0; i < 5; ++i) run.advance_frame();
  CHECK(run.solid().momentum(run.state().motion).z() == Approx((2 * 0.25 - 2 * 0.1 - 4 * 0.15) * mass_of(run)));
  std::ostringstream text;
  write_scene(text, recording_of(scene, run), "");
  Simulation replay(parse_scene(text.str(), "recorded.toml"), cube);
  for (int i = 0; i < 10; ++i) replay.advance_frame();
  CHECK(bytes(replay) == bytes(run));
}

TEST_CASE("a grip ends once, and blades and pulls with one key do not exist", "[hands]") {
  const Scene scene = cube_scene();
  const TriangleMesh cube = make_block({1, 1, 1}, 0.25);
  Simulation run(scene, cube), other(scene, cube);
  auto grip = run.add_grip({.lo = {-1, -1, 0.6}, .hi = {2, 2, 2}, .motion = {}});
  grip.end();
  Blade wedge{.name = "b", .points = {{0, -1, 0}, {0, 2, 0}}, .motion = {}};
  wedge.back = {0, 0, 0.5};
  wedge.thickness = 0.3;
  run.add_blade(wedge, at({0.5, 0, 0.5}, 0));
  run.add_pull({.point = {0.5, 0.5, 0.98}, .motion = {}}, {0.5, 0.5, 3});
  for (int i = 0; i < 3; ++i) {
    run.advance_frame();
    other.advance_frame();
  }
  grip.end();
  CHECK(run.scene().grips[grip.index()].until == 0);
  CHECK(run.state().motion.displacement == other.state().motion.displacement);
  const Scene recording = recording_of(scene, run);
  CHECK(recording.blades.empty());
  CHECK(recording.pulls.empty());
  CHECK(recording.grips.size() == 1);
}

TEST_CASE("what is driven keeps its keys up to now, and begins anew where it was removed", "[hands]") {
  Scene scene = cube_scene();
  scene.blades.push_back({.name = "b", .points = {{0, -1, 3}, {0, 2, 3}}});
  Simulation run(scene, make_block({1, 1, 1}, 0.25));
  auto blade = run.blade(0);
  const auto x = [&] { return blade.pose().position.x(); };
  const auto count = [&] { return blade.motion().keys.size(); };
  CHECK(x() == 0);
  blade.drive_to(at({9, 0, 0}, 0));
  blade.drive_to(at({1, 0, 0}, 3));  // the last call of a frame counts
  CHECK(count() == 2);
  run.advance_frame();
  CHECK(x() == 1);
  blade.drive_to(at({3, 0, 0}, 5));
  CHECK(count() == 3);
  run.advance_frame();
  CHECK(blade.motion().at(0.75 * run.state().time).position.x() == Approx(2));
  run.advance_frame();
  CHECK_FALSE(run.scene().blades[0].active(run.state().time));
  CHECK(x() == 3);
  blade.drive_to(at({4, 0, 0}, 5));
  CHECK(count() == 2);
  CHECK(x() == 3);
  // A grip stays, and keeps all keys.
  auto grip = run.add_grip({.lo = {-1, -1, 0.6}, .hi = {2, 2, 2}, .motion = {}});
  grip.drive_to(at({0, 0, 0.1}, 0));
  for (int i = 0; i < 3; ++i) run.advance_frame();
  CHECK(grip.pose().position.z() == 0.1);
  grip.drive_to(at({0, 0, 0.2}, 0));
  CHECK(grip.motion().keys.size() == 4);
  auto pull = run.add_pull({.point = {0.5, 0.5, 0.98}, .motion = {}}, {0.5, 0.5, 3});
  for (int i = 0; i < 4; ++i) {
    pull.drive_to({0.5, 0.5, 3});
    run.advance_frame();
  }
  CHECK(pull.end() == Vec3(0.5, 0.5, 3));
  CHECK(run.scene().pulls[pull.index()].motion.keys.size() == 2);
}

TEST_CASE("what hands did, given as a scene, gives the same run to the bit", "[hands]") {
  for (const bool implicit : {true, false}) {
    const Handled live = handled(implicit);
    Simulation replay(live.scene, make_block({1, 1, 1}, 0.25));
    for (int i = 0; i < 10; ++i) replay.advance_frame();
    CHECK(find_pieces(replay.body().surface).count == 2);
    CHECK(bytes(replay) == live.bytes);
    // Through a file, and from a checkpoint on the way.
    Scene written = live.scene;
    std::ostringstream text;
    write_scene(text, written, "");
    const Scene read = parse_scene(text.str(), "recorded.toml");
    Simulation again(read, make_block({1, 1, 1}, 0.25));
    for (int i = 0; i < 10; ++i) {
      again.advance_frame();
      if (i == 5) again = read_back(read, bytes(again));
    }
    CHECK(bytes(again) == live.bytes);
    again.restore(Body(again.body()), RunState(again.state()));
    CHECK(bytes(again) == live.bytes);
  }
}

TEST_CASE("a written scene is read back to the bit, with everything that a scene can have", "[hands]") {
  const std::string text = R"(
gravity = [0.1, 0.30000000000000004, -9.81]
[[body]]
name = "a \"quoted\" one"
mesh = "cube.ply"
nodes = 100
levels = 3
scale = 0.7
rotation = [1, 2, 3, 33]
position = [0, 1e-17, 3]
fixed = [[0, 0, 0, 1, 1, 0.1]]
[[body]]
mesh = "other.ply"
spacing_percent = 7
velocity = [1, 0, 0]
spin = [0, 0, 0.1]
[body.material]
young = 5e5
model = "stvk"
volume_term = 1e4
yield = 0.1
[body.fracture]
strength = 7e3
[material]
young = 3.3333333333333335e4
discretisation = "mueller04"
[fracture]
strength = 2e4
branching = 1.7
off = [[0, 0, 0, 1, 1, 1], [2, 2, 2, 3, 3, 3]]
[ground]
point = [0, 0, -1]
normal = [0, 0.1, 1]
friction = 0.25
[contact]
self = true
bodies = false
[time]
frames = 7
frame_rate = 60
step = 0.016
checkpoints = [3, 9]
integrator = "leapfrog"
seed = 12
[[grip]]
box = [0, 0, 0, 1, 1, 1]
from = 0.5
until = 2.25
release = true
keys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, 1, 0, 1, 0, 720]]
[[obstacle]]
normal = [0, 1, 0]
rotation = [0, 0, 1, 12]
friction = 0.1
keys = [[0, 0, 0, 0, 0, 0, 1, 0]]
[[blade]]
points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
closed = true
divide = 3
keys = [[0, 0, 0, 0, 0, 0, 1, 0], [0.1, 0, 0, 1, 0, 0, 1, 0]]
back = [0, 0, 1]
thickness = 0.1
[[pull]]
point = [0.1, 0.2, 0.3]
node = 4
stiffness = 30
keys = [[0, 0, 0, 0, 0, 0, 1, 0], [0.1, 0, 0, 1, 0, 0, 1, 0]]
[[change]]
time = 0.1
young = 2e4
damping = 0.5
[[change]]
time = 0.1
friction = 0.5
gravity = [0, 0, 1]
accuracy = 0.02
step = 0.001
)";
  const Scene first = parse_scene(text, "s.toml");
  REQUIRE(first.bodies.size() == 2);
  REQUIRE(first.pulls.size() == 1);
  REQUIRE(first.changes.size() == 2);
  CHECK(first.grips[1].until == 2.25);
  std::ostringstream once, twice;
  write_scene(once, first, "");
  const Scene second = parse_scene(once.str(), "written.toml");
  write_scene(twice, second, "");
  CHECK(once.str() == twice.str());
  CHECK(second.bodies[0].place.rotation.coeffs() == first.bodies[0].place.rotation.coeffs());
  CHECK(second.bodies[0].name == first.bodies[0].name);
  CHECK(second.bodies[1].material == first.bodies[1].material);
  CHECK(second.fracture.per_body == first.fracture.per_body);
  CHECK(second.gravity == first.gravity);
  CHECK(second.blades[0].points == first.blades[0].points);
  CHECK(second.checkpoints == std::vector<int>{3, 9});
  CHECK(second.obstacles[0].place.rotation.coeffs() == first.obstacles[0].place.rotation.coeffs());
  Scene unwritable = first;
  unwritable.obstacles[0].mesh = make_block({1, 1, 1}, 0.5);
  CHECK_THROWS_AS(write_scene(once, unwritable, ""), InputError);
  unwritable = first;
  unwritable.scores.resize(1);
  CHECK_THROWS_AS(write_scene(once, unwritable, ""), InputError);
}

TEST_CASE("keys of springs, pins and changes are checked", "[hands]") {
  const std::string body = "[body]\nmesh = \"a\"\n";
  const auto refused = [&](const std::string& text, const std::string& what) {
    CHECK_THROWS_WITH(parse_scene(body + text, "s.toml"), Catch::Contains(what));
  };
  refused("[[pull]]\nstiffness = 1\n", "'pull.point' is missing");
  refused("[[pull]]\npoint = [0, 0, 0]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0]]\n", "two 'keys'");
  refused("[[change]]\nyoung = 1\n", "'change.time' is missing");
  refused("[[change]]\ntime = 1\nfriction = 2\n", "'friction' must be from 0 to 1");
  refused("[[change]]\ntime = 1\n[[change]]\ntime = 0.5\n", "ascend in time");
  refused("[time]\ncheckpoints = [3, 2]\n", "ascending");
  refused("quaternion = [1, 1, 0, 0]\n", "norm 1");
}
