#include <catch2/catch.hpp>

#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

const char* scene_text = R"(
gravity = [0, 0, -2]
[body]
mesh = "cube.ply"
spacing = 0.2
[material]
young = 3e4
damping = 0.0
[time]
frames = 6
frame_rate = 20
step = 0.025
[[blade]]
points = [[-0.4, 0, 0], [1.4, 0, 0]]
divide = 6
keys = [[0.0, 0.013, 0.507, 1.3, 0, 0, 1, 2], [0.2, 0.013, 0.511, -0.7, 0, 0, 1, 3]]
)";

}  // namespace

TEST_CASE("a scene is read, overridden, and refused with line and column") {
  const Scene s = parse_scene(scene_text, "s.toml", {{"material.young", "5e4"}, {"time.frames", "3"}});
  CHECK(s.material.young == 5e4);
  CHECK(s.frames == 3);
  REQUIRE(s.blades.size() == 1);
  CHECK(s.blades[0].points.size() == 7);
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\ncolour = 3\n", "s.toml"),
                    Catch::Contains("s.toml:3:") && Catch::Contains("unknown key 'body.colour'"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\n[material]\nyoung = \"stiff\"\n", "s.toml"),
                    Catch::Contains("s.toml:4:"));
  CHECK_THROWS_WITH(parse_scene("[body\n", "s.toml"), Catch::Contains("s.toml:1:"));
  CHECK_THROWS_AS(parse_scene("", "s.toml"), InputError);
  // Errors: misspelt keys, numbers out of range, keys that exclude each other.
  CHECK_THROWS_WITH(parse_scene("[body]\nmsh = \"a\"\n", "s.toml"),
                    "s.toml:2:7: unknown key 'body.msh'; did you mean 'mesh'?");
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\n[fracture]\nstrenght = 1\n", "s.toml"),
                    Catch::Contains("'fracture.strenght'; did you mean 'strength'?"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\n", "s.toml", {{"materail.young", "1"}}),
                    Catch::Contains("did you mean 'material'?"));
  CHECK_THROWS_WITH(parse_scene("[bodi]\nmesh = \"a\"\n", "s.toml"), Catch::Contains("did you mean 'body'?"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\n[material]\npoisson = 0.5\n", "s.toml"),
                    Catch::Contains("from -0.99 to 0.4999"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\nnodes = 5\nspacing = 0.1\n", "s.toml"),
                    Catch::Contains("one of 'spacing'"));
  CHECK(
      parse_scene("[body]\nmesh = \"a\"\nnodes = 5\n", "s.toml", {{"body.spacing", "0.5"}}).bodies[0].sampling.count ==
      0);
}

TEST_CASE("a blade turns and moves by its keys") {
  Blade blade;
  blade.points = {{1, 0, 0}, {2, 0, 0}};
  blade.motion.keys = {{0, {0, 0, 0}, {0, 0, 1}, 0}, {2, {0, 0, 4}, {0, 0, 1}, 90}};
  const auto p = blade.at(1);
  CHECK(p[0].z() == Approx(2));
  CHECK(p[0].x() == Approx(std::sqrt(0.5)));
  CHECK(p[1].y() == Approx(2 * std::sqrt(0.5)));
}

TEST_CASE("a falling cube is halved and both halves go on falling as one") {
  const Scene scene = parse_scene(scene_text, "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.2));
  FrameStats work;
  for (int i = 0; i < scene.frames; ++i) work += sim.advance_frame();
  CHECK(work.refused == 0);
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK(check_body(sim.body()).first_problem == "");
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  // Centre of mass on the parabola of the discrete steps.
  const auto& state = sim.state();
  double mass = 0, z = 0, rest = 0;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    const double m = sim.solid().mass(NodeId(i));
    mass += m;
    z += m * state.motion.velocity[i].z();
    rest += sim.body().nodes.volume[i];
  }
  CHECK(rest == Approx(1).epsilon(1e-12));
  CHECK(z / mass == Approx(-2 * 0.3).epsilon(1e-6));
  const TriangleMesh surface = sim.surface();
  CHECK(signed_volume(surface) == Approx(1).epsilon(0.05));
}

TEST_CASE("a solid is up to date whenever it is asked for, and a run does not depend on that") {
  const SceneOverrides variants[] = {{},
                                     {{"material.yield", "0.01"}},
                                     {{"contact.self", "true"}},
                                     {{"time.integrator", "leapfrog"}, {"time.step", "0.0005"}},
                                     {{"time.step", "0.0125"}}};
  const SceneOverrides overrides = variants[GENERATE(0, 1, 2, 3, 4)];
  const std::string second =
      "[[blade]]\npoints = [[-0.4, 0, 0], [1.4, 0, 0]]\ndivide = 6\nkeys = [[0.1, 0.013, 0.307, 1.3, 0, 0, 1, 2], "
      "[0.3, 0.013, 0.311, -0.7, 0, 0, 1, 3]]\n";
  const Scene scene = parse_scene(scene_text + second, "s.toml", overrides);
  Simulation asked(scene, make_block({1, 1, 1}, 0.2)), other(scene, make_block({1, 1, 1}, 0.2));
  std::size_t cuts = 0;
  for (int i = 0; i < scene.frames; ++i) {
    cuts += asked.advance_frame().split.crack.new_crack_faces > 0;
    other.advance_frame();
    const std::vector<Vec3>& u = asked.state().motion.displacement;
    const Solid fresh(asked.body(), asked.solid().materials());
    CHECK(asked.solid().point_count() == fresh.point_count());
    CHECK(asked.solid().energy(u) == fresh.energy(u));
    CHECK(u == other.state().motion.displacement);
  }
  CHECK(cuts > 0);
  CHECK(asked.solid().energy(asked.state().motion.displacement) ==
        other.solid().energy(other.state().motion.displacement));
}

TEST_CASE("a thick blade presses the sheets apart, and the material exerts a force on it") {
  const auto run = [](const std::string& thickness) {
    const Scene scene = parse_scene(
        "gravity = [0, 0, 0]\n[body]\nmesh = 'a'\nspacing = 0.2\nfixed = [[-1, -1, -1, 2, 2, "
        "0.15]]\n[time]\nframe_rate = 10\nstep = 0.05\n[[blade]]\n"
        "points = [[0, -0.3, 0], [0, 1.3, 0]]\ndivide = 8\nkeys = [[0, 0.507, 0, 1.2, 0, 0, 1, 2], [0.4, 0.503, 0, "
        "0.4, 0, 0, 1, 2]]\nback = [0, 0, 1]\nthickness = " +
            thickness,
        "s.toml");
    Simulation sim(scene, make_block({1, 1, 1}, 0.2));
    Vec3 force = Vec3::Zero();
    for (int i = 0; i < 4; ++i) {
      const FrameStats work = sim.advance_frame();
      CHECK(work.refused == 0);
      force += work.blade_force.at(0);
    }
    double left = 0, right = 0;
    for (std::size_t i = 0; i < sim.body().nodes.size(); ++i)
      if (sim.body().nodes.position[i].z() > 0.7)
        (sim.body().nodes.position[i].x() < 0.5 ? left : right) +=
            sim.state().motion.displacement[i].x() * sim.body().nodes.volume[i];
    return std::tuple(left, right, force);
  };
  const auto [left, right, force] = run("0.3");
  CHECK(left < -0.001);
  CHECK(right > 0.001);
  CHECK(force.z() > 0);  // it is held up
  CHECK(std::abs(force.x()) < force.z());
  const auto [still_left, still_right, none] = run("0.0");
  CHECK(std::abs(still_left) + std::abs(still_right) < 1e-6);
  CHECK(none == Vec3::Zero());
}

TEST_CASE("a grip carries the nodes that it holds, and lets go") {
  const Scene scene = parse_scene(
      "gravity = [0, 0, 0]\n[body]\nmesh = 'a'\nspacing = 0.25\n[time]\nframe_rate = 10\nstep = 0.05\n[[grip]]\nbox = "
      "[-1, -1, 0.8, 2, 2, 2]\n"
      "keys = [[0, 0, 0, 0, 0, 0, 1, 0], [0.2, 0, 0, 0.1, 0, 0, 1, 0]]\nrelease = true\n",
      "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.25));
  sim.advance_frame();
  sim.advance_frame();
  std::size_t held = 0;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i)
    if (sim.body().nodes.position[i].z() > 0.8) {
      ++held;
      CHECK((sim.state().motion.displacement[i] - Vec3(0, 0, 0.1)).norm() < 1e-12);
      CHECK((sim.state().motion.velocity[i] - Vec3(0, 0, 0.5)).norm() < 1e-9);
    }
  CHECK(held > 0);
  const auto energy = [](const Simulation& run) { return run.solid().energy(run.state().motion.displacement); };
  CHECK(energy(read_back(scene, bytes(sim))) == energy(sim));  // held material, too
  const Vec3 before = sim.state().motion.displacement.back();
  sim.advance_frame();
  CHECK(sim.state().motion.displacement.back() != before);
}

TEST_CASE("bodies with velocities and prescored fronts begin as the scene says") {
  Scene scene = parse_scene(
      "gravity = [0, 0, 0]\n[[body]]\nmesh = 'a'\nspacing = 0.25\nvelocity = [0, 0, 1]\n[[body]]\nmesh = 'b'\nspacing "
      "= 0.25\nscale = 0.5\nposition = [3, 0, 0]\nrotation = [0, 0, 1, 90]\nspin = [0, 0, 2]\n",
      "s.toml");
  Front front{"score", false, {{{-0.3, 0.507, 1.3}, {1.3, 0.503, 1.3}}, {{-0.3, 0.511, -0.3}, {1.3, 0.509, -0.3}}}};
  Front sheet{"sheet", false, {{{2, 0.213, -1}, {4, 0.213, -1}, {3, 0.219, 2}}}, {{0, 1, 2}}};
  scene.scores = {{front}, {sheet}};
  const PlacedModels model = place_models(scene, {make_block({1, 1, 1}, 0.25), make_block({1, 1, 1}, 0.25)});
  const Simulation sim(scene, model);
  const Pieces pieces = find_pieces(sim.body().surface);
  CHECK(pieces.count == 4);
  CHECK(check_body(sim.body()).first_problem == "");
  double volume = 0;
  for (const double v : pieces.volume) volume += v;
  CHECK(volume == Approx(1.125).epsilon(1e-12));
  Vec3 turning = Vec3::Zero();
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    const Vec3& v = sim.state().motion.velocity[i];
    if (sim.state().body_index[i] == 0)
      CHECK(v == Vec3(0, 0, 1));
    else
      turning += (sim.body().nodes.position[i] - Vec3(2.75, 0.25, 0.25)).cross(v);
  }
  CHECK(turning.z() > 0);
}

TEST_CASE("a program can move blades, grips and obstacles from frame to frame") {
  // The same straight cut, by keyframes and by poses for each frame.
  const int frames = 6;
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.25;
  scene.gravity = Vec3::Zero();
  scene.dt = 1 / scene.frame_rate;
  scene.grips.push_back({Vec3(-0.01, -0.01, -0.01), Vec3(0.2, 1.01, 1.01), {}, false});
  Blade blade;
  blade.points = {{0.52, -0.2, 1.2}, {0.51, 1.2, 1.2}};
  blade.motion.keys = {{0, Vec3::Zero()}, {frames / scene.frame_rate, Vec3(0, 0, -1.5)}};
  scene.blades.push_back(blade);
  Simulation keyed(scene, make_block({1, 1, 1}, 0.25));
  scene.blades[0].motion.keys.clear();
  Simulation steered(scene, make_block({1, 1, 1}, 0.25));
  for (int f = 1; f <= frames; ++f) {
    keyed.advance_frame();
    Pose pose;
    pose.position.z() = -1.5 * f / frames;
    steered.blade(0).drive_to(pose);
    steered.advance_frame();
    CHECK((steered.scene().blades[0].motion.at(1e9).position - pose.position).norm() < 1e-15);
  }
  CHECK(find_pieces(steered.body().surface).count == 2);
  CHECK(find_pieces(keyed.body().surface).count == 2);
  // Without a call the blade is gone; a grip keeps its last pose.
  steered.grip(0).drive_to({Vec3(0, 0, 0.1), Eigen::Quaterniond::Identity()});
  CHECK(steered.advance_frame().split.crack.triangles_cut == 0);
  CHECK(steered.advance_frame().fronts == 0);
  for (int extra = 0; extra < 2; ++extra) {
    double highest = 0;
    for (std::size_t i = 0; i < steered.body().nodes.size(); ++i)
      if ((steered.body().nodes.position[i].array() <= Vec3(0.2, 1.01, 1.01).array()).all())
        highest = std::max(highest, std::abs(steered.state().motion.displacement[i].z() - 0.1));
    CHECK(highest < 1e-12);
    steered.advance_frame();
  }
  CHECK_THROWS_AS(steered.obstacle(0), std::out_of_range);
}
