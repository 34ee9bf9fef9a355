// Scenes whose bodies have different materials.
#include <catch2/catch.hpp>

#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

// A hard body beside a soft plastic one, both cut by a blade.
const char* two = R"(
gravity = [0, 0, -2]
[material]
young = 2e4
damping = 3
viscosity = 20
[ground]
[[body]]
mesh = "a"
spacing = 0.25
position = [0, 0, 0.02]
[[body]]
mesh = "b"
spacing = 0.25
position = [1.1, 0, 0.02]
[body.material]
young = 4e5
density = 3000
yield = 0.01
creep = 5
[time]
frames = 6
frame_rate = 20
step = 0.025
[[blade]]
points = [[-0.4, 0, 0], [2.5, 0, 0]]
divide = 10
keys = [[0.0, 0.013, 0.507, 1.3, 0, 0, 1, 2], [0.2, 0.013, 0.511, -0.7, 0, 0, 1, 3]]
)";

PlacedModels cubes(const Scene& scene) {
  return place_models(scene, {make_block({1, 1, 1}, 0.25), make_block({1, 1, 1}, 0.25)});
}

}  // namespace

TEST_CASE("a body's material has the scene's where it says nothing") {
  const Scene s = parse_scene(two, "s.toml");
  REQUIRE(s.bodies.size() == 2);
  CHECK_FALSE(s.bodies[0].material);
  REQUIRE(s.bodies[1].material);
  CHECK(s.bodies[1].material->young == 4e5);
  CHECK(s.bodies[1].material->damping == 3);
  CHECK(s.bodies[1].material->poisson == Material().poisson);
  // In a table of its own, in braces, on the command line; before and after the scene's.
  const Scene one = parse_scene("[body]\nmesh = 'a'\nmaterial = { poisson = 0.1 }\n[material]\nyoung = 7\n", "s.toml");
  CHECK(one.bodies[0].material->poisson == 0.1);
  CHECK(one.bodies[0].material->young == 7);
  CHECK(parse_scene("[body]\nmesh = 'a'\n[body.material]\nmodel = 'stvk'\n", "s.toml").bodies[0].material->model ==
        ElasticModel::saint_venant_kirchhoff);
  const Scene set = parse_scene(
      two, "s.toml", {{"body.0.material.young", "9"}, {"body.1.material.young", "8"}, {"material.viscosity", "0"}});
  CHECK(set.bodies[0].material->young == 9);
  CHECK(set.bodies[0].material->damping == 3);
  CHECK(set.bodies[1].material->young == 8);
  CHECK(set.bodies[1].material->yield == 0.01);
  CHECK(set.bodies[1].material->viscosity == 0);
  CHECK(set.fingerprint != s.fingerprint);
}

TEST_CASE("what a body's material cannot have is refused with its line") {
  const auto parse = [](const std::string& keys) {
    return parse_scene("[body]\nmesh = 'a'\n[body.material]\n" + keys, "s.toml");
  };
  CHECK_THROWS_WITH(parse("yuong = 3\n"), "s.toml:4:9: unknown key 'body.material.yuong'; did you mean 'young'?");
  CHECK_THROWS_WITH(parse("poisson = 0.5\n"),
                    Catch::Contains("s.toml:4:") && Catch::Contains("'body.material.poisson' is out of range"));
  CHECK_THROWS_WITH(parse("model = 'jelly'\n"),
                    Catch::Contains("s.toml:4:") && Catch::Contains("'body.material.model' must be"));
  CHECK_THROWS_WITH(parse("discretisation = 'galerkin'\n"),
                    Catch::Contains("s.toml:4:") && Catch::Contains("same for all bodies"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = 'a'\nmaterial = 3\n", "s.toml"),
                    Catch::Contains("'body.material' must be a table"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = 'a'\nmaterail = { young = 3 }\n", "s.toml"),
                    Catch::Contains("did you mean 'material'?"));
  CHECK_THROWS_WITH(parse_scene(two, "s.toml", {{"body.2.material.young", "1"}}), Catch::Contains("body.2"));
}

TEST_CASE("cut bodies of two materials keep theirs, and a run taken up goes on with the same bytes") {
  const Scene scene = parse_scene(two, "s.toml");
  Simulation sim(scene, cubes(scene));
  std::string kept;
  for (int frame = 0; frame < scene.frames; ++frame) {
    if (frame == 3) kept = bytes(sim);
    CHECK(sim.advance_frame().refused == 0);
  }
  Simulation again = read_back(scene, kept);
  for (int frame = 3; frame < scene.frames; ++frame) again.advance_frame();
  CHECK(bytes(again) == bytes(sim));
  double mass[2] = {0, 0}, lowest[2] = {1, 1};
  const auto& state = sim.state();
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    CHECK(sim.solid().materials().of(i).density == (state.body_index[i] == 0 ? 1000 : 3000));
    mass[state.body_index[i]] += sim.solid().mass(NodeId(i));
    lowest[state.body_index[i]] = std::min(lowest[state.body_index[i]], state.motion.displacement[i].z());
  }
  CHECK(mass[0] == Approx(1000).epsilon(1e-12));
  CHECK(mass[1] == Approx(3000).epsilon(1e-12));
  CHECK(lowest[0] < 0.5 * lowest[1]);  // the ground throws the stiff one up, the soft one yields
  // Checkpoints with more bodies than the scene, and with too few indices.
  RunState wrong = sim.state();
  wrong.body_index.back() = 2;
  CHECK_THROWS_WITH(Simulation(scene, sim.body(), wrong), Catch::Contains("does not belong to this scene"));
  wrong.body_index.back() = 1;
  wrong.body_index.pop_back();
  CHECK_THROWS_WITH(Simulation(scene, sim.body(), wrong), Catch::Contains("does not belong to this scene"));
}

TEST_CASE("a heavy body among light ones does not sink into an obstacle") {
  for (const std::string integrator : {"implicit", "leapfrog"}) {
    const Scene scene = parse_scene(
        "[material]\nyoung = 1e6\ndamping = 8\ndensity = 10\n[[body]]\nmesh = 'a'\nspacing = 0.25\n[[body]]\nmesh = "
        "'b'\nspacing = 0.25\nposition = [2, 0, 0]\n"
        "[body.material]\nyoung = 1e8\ndensity = 8000\n[[obstacle]]\nnormal = [0, 0, 1]\nstiffness = "
        "1e4\n[time]\nframe_rate = 10\nstep = 0.02\nintegrator = '" +
            integrator + "'\n",
        "s.toml");
    Simulation sim(scene, cubes(scene));
    for (int frame = 0; frame < 6; ++frame) sim.advance_frame();
    double deepest[2] = {0, 0};
    for (const Vec3& x : sim.surface().vertices) deepest[x.x() > 1.5] = std::min(deepest[x.x() > 1.5], x.z());
    INFO(integrator << ": " << deepest[0] << ", " << deepest[1]);
    // A column of four layers stands on the lowest one's penalty.
    for (const double z : deepest) CHECK(-z < 3 * 4 * 9.81 / 1e4);
    CHECK(deepest[1] < 0);
  }
}

TEST_CASE("surfaces of a hard and a soft body that meet do not go far") {
  const Scene scene = parse_scene(
      "[material]\nyoung = 2e4\ndamping = 4\n[[body]]\nmesh = 'a'\nspacing = 0.25\nfixed = "
      "[[-1, -1, -1, 3, 3, 0.2]]\n[[body]]\nmesh = 'b'\nspacing = 0.25\n"
      "scale = 0.5\nposition = [0.23, 0.27, 1.02]\n[body.material]\nyoung = 1e7\ndensity = "
      "600\n[time]\nframe_rate = 20\nstep = 0.025\n",
      "s.toml");
  Simulation sim(scene, cubes(scene));
  FrameStats work;
  for (int frame = 0; frame < 8; ++frame) work += sim.advance_frame();
  // It stands on the other one, dents it, and keeps its own shape.
  double middle = 0, count = 0;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i)
    if (sim.state().body_index[i] != 0) {
      middle += sim.state().motion.displacement[i].z();
      ++count;
    }
  INFO(middle / count);
  CHECK(middle / count < -0.02);
  CHECK(middle / count > -0.3);
  CHECK(work.contact.touching > 0);
}

TEST_CASE("bodies pulled alike break where their own strength says", "[fracture]") {
  const auto broken = [](const std::string& all, const std::string& of_second) {
    const Scene scene = parse_scene(
        "gravity = [0, 0, 0]\n[material]\nyoung = 1e6\ndamping = 30\n[fracture]\ncracks = 2\nstrength = " + all +
            "\n[[body]]\nmesh = 'a'\nspacing = 0.2\nfixed = [[-1, -1, -1, 0.2, 9, 9]]\n"
            "[[body]]\nmesh = 'b'\nspacing = 0.2\nposition = [0, 1, 0]\n[body.material]\ndensity = "
            "1200\n[body.fracture]\n" +
            of_second +
            "\n[[grip]]\nbox = [1.8, -1, -1, 3, 9, 9]\n"
            "keys = [[0, 0, 0, 0, 0, 0, 1, 0], [0.1, 0.08, 0, 0, 0, 0, 1, 0]]\n[time]\nframe_rate = 20\nstep = 0.025\n",
        "s.toml");
    const TriangleMesh bar = make_block({2, 0.5, 0.5}, 0.25);
    Simulation sim(scene, place_models(scene, {bar, bar}));
    std::string kept;
    for (int frame = 0; frame < 4; ++frame) {
      if (frame == 2) kept = bytes(sim);
      sim.advance_frame();
    }
    Simulation again = read_back(scene, kept);
    again.advance_frame();
    again.advance_frame();
    CHECK(bytes(again) == bytes(sim));
    std::size_t faces[2] = {0, 0};
    const Complex& k = sim.body().surface;
    for (std::uint32_t f = 0; f < k.face_count(); ++f)
      if (k.alive(FaceId(f)) && k.face(FaceId(f)).crack != 0) ++faces[k.corners(FaceId(f))[0].y() > 0.75];
    return std::array{faces[0] > 0, faces[1] > 0};
  };
  CHECK(broken("1e4", "strength = 1e9") == std::array{true, false});
  CHECK(broken("1e9", "strength = 1e4") == std::array{false, true});
  CHECK(broken("1e9", "toughness = 10") == std::array{false, false});
}

TEST_CASE("how strong a body is has the scene's fracture to go by") {
  const auto parse = [](const std::string& text) { return parse_scene("[body]\nmesh = 'a'\n" + text, "s.toml"); };
  CHECK(parse("[fracture]\nstrength = 3\n").fracture.per_body.empty());
  const Scene s = parse("[body.fracture]\ntoughness = 5\n[fracture]\nstrength = 3\n");
  REQUIRE(s.fracture.per_body.size() == 1);
  CHECK(s.fracture.per_body[0].strength == 3);
  CHECK(s.fracture.per_body[0].toughness == 5);
  CHECK(s.fracture.toughness == 0);
  CHECK_THROWS_WITH(parse("fracture = { strength = 1 }\n"),
                    Catch::Contains("s.toml:3:") && Catch::Contains("give the scene a [fracture]"));
  CHECK_THROWS_WITH(
      parse("fracture = { speed = 1 }\n[fracture]\n"),
      Catch::Contains("s.toml:3:") && Catch::Contains("'body.fracture.speed' is the same for all bodies"));
  CHECK_THROWS_WITH(parse("fracture = { strenght = 1 }\n[fracture]\n"),
                    Catch::Contains("'body.fracture.strenght'; did you mean 'strength'?"));
}
