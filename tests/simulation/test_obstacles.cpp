// Obstacles in scenes: friction, balance of forces, motion, both integrators, threads and
// checkpoints.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "kerf/body_file.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

// A scene of one body, with obstacles of these meshes.
Scene scene_of(const std::string& text, const std::vector<TriangleMesh>& meshes = {}) {
  Scene scene = parse_scene("[body]\nmesh = 'a'\nspacing = 0.25\n" + text, "s.toml");
  for (std::size_t i = 0; i < meshes.size(); ++i) scene.obstacles.at(i).mesh = meshes[i];
  return scene;
}

struct Middle {
  double mass = 0;
  Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();
};
Middle middle_of(const Simulation& sim) {
  Middle m;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    const double mass = sim.solid().mass(NodeId(i));
    m.mass += mass;
    m.place += mass * (sim.body().nodes.position[i] + sim.state().motion.displacement[i]);
    m.velocity += mass * sim.state().motion.velocity[i];
  }
  m.place /= m.mass;
  m.velocity /= m.mass;
  return m;
}

}  // namespace

TEST_CASE("a block on an inclined obstacle stays below the angle of friction, and slides as it should above") {
  // A slab as obstacle, and the block on it, both turned: the slope falls towards +x.
  for (const char* integrator : {"implicit", "leapfrog"})
    for (const double degrees : {15.0, 40.0}) {
      INFO(integrator << ", " << degrees << " degrees");
      const double damping = integrator[0] == 'i' ? 0 : 3;  // leapfrog has none of its own: the block would hop
      const std::string turn = "[0, 1, 0, " + std::to_string(degrees) + "]";
      Scene scene = scene_of("rotation = " + turn + "\n[material]\nyoung = 1e5\ndamping = " + std::to_string(damping) +
                                 "\n[time]\nframes = 10\nframe_rate = 20\nstep = "
                                 "0.01\nintegrator = '" +
                                 std::string(integrator) +
                                 "'\n[[obstacle]]\nnormal = [0, 0, 1]\nposition = [0, 0, 0]\nrotation = " + turn +
                                 "\nstiffness = 1e4\nfriction = 0.4\n",
                             {make_block({20, 20, 1}, 5)});
      for (Vec3& p : scene.obstacles[0].mesh.vertices) p -= Vec3(10, 10, 1);
      PlacedModels model = place_models(scene, {make_block({1, 1, 0.5}, 0.25)});
      Simulation sim(scene, model);
      const double angle = degrees * std::numbers::pi / 180, g = 9.81;
      const Vec3 down(std::cos(angle), 0, -std::sin(angle));
      for (int i = 0; i < 8; ++i) sim.advance_frame();
      const Middle begin = middle_of(sim);
      for (int i = 0; i < 8; ++i) sim.advance_frame();
      const Middle end = middle_of(sim);
      // v' = a − damping v
      const double fade = std::exp(-damping * 0.4), share = damping > 0 ? (1 - fade) / damping : 0.4;
      const double gained = down.dot(end.velocity - fade * begin.velocity) / share;
      if (degrees < 20) {
        CHECK(std::abs(down.dot(end.place - begin.place)) < 0.002);
      } else {
        CHECK(gained == Approx(g * (std::sin(angle) - 0.4 * std::cos(angle))).epsilon(0.03));
      }
      CHECK(std::abs(end.place.y() - begin.place.y()) < 1e-3);
    }
}

TEST_CASE("what obstacles take in a frame is what the body's momentum lacks, with either integrator") {
  for (const char* integrator : {"implicit", "leapfrog"}) {
    INFO(integrator);
    const Scene scene = scene_of(
        "velocity = [0.6, 0.2, -1]\nposition = [-0.5, -0.5, 1.05]\n[material]\nyoung = 5e4\ndamping = "
        "0\n[time]\nframes = 8\nframe_rate = 40\nstep = 0.0125\naccuracy = 1e-6\nintegrator = '" +
            std::string(integrator) +
            "'\n[[obstacle]]\nnormal = [0, 0, 1]\nstiffness = 1e4\nkeys = [[0, 0, 0, 0, 0, 1, 0, 0], [1, 0.2, 0, 0.1, "
            "0, 1, 0, 20]]\n",
        {make_sphere(8)});
    Simulation sim(scene, place_models(scene, {make_block({1, 1, 1}, 0.125)}));
    double most = 0;
    for (int i = 0; i < 8; ++i) {
      const Middle before = middle_of(sim);
      const FrameStats work = sim.advance_frame();
      const Middle after = middle_of(sim);
      const Vec3 weight = before.mass * scene.gravity, gained = before.mass * (after.velocity - before.velocity) * 40;
      REQUIRE(work.obstacle_force.size() == 1);
      most = std::max(most, work.obstacle_force[0].norm());
      CHECK((gained - weight + work.obstacle_force[0]).norm() <
            (integrator[0] == 'i' ? 2e-3 : 1e-9) * (weight.norm() + most));
    }
    CHECK(most > 500);  // of 9.8 kN
  }
}

TEST_CASE("a cut body on obstacles: the same with any threads, and after a checkpoint") {
  for (const std::string& contact :
       {std::string(), std::string("[contact]\nself = true\n[ground]\npoint = [0, 0, 0]\n")}) {
    const Scene scene =
        scene_of("position = [-0.5, -0.5, 1]\n[material]\nyoung = 2e4\n" + contact +
                     "[time]\nframes = 8\nframe_rate = 20\nstep = 0.025\n[[obstacle]]\nnormal = [0, 0, 1]\nstiffness = "
                     "1e4\n[[obstacle]]\nnormal = [0, 0.2, -1]\nposition = [0, 0, 2.2]\n"
                     "keys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, -1.6, 0, 0, 1, 0]]\n[[blade]]\npoints = [[-0.9, 0, "
                     "0], [0.9, 0, 0]]\ndivide = 6\n"
                     "keys = [[0.0, 0.013, 0.007, 2.3, 0, 0, 1, 2], [0.3, 0.013, 0.011, 1.3, 0, 0, 1, 3]]\n",
                 {make_sphere(6)});
    const PlacedModels model = place_models(scene, {make_block({1, 1, 1}, 0.2)});
    set_threads(2);
    Simulation sim(scene, model);
    FrameStats work;
    std::string half;
    double lifted = 0;  // the second obstacle: it comes down about as fast as the body sinks
    for (int i = 0; i < 8; ++i) {
      work = sim.advance_frame();
      lifted = std::max(lifted, work.obstacle_force.at(1).z());
      if (i == 3) {
        half = bytes(sim);
        sim = read_back(scene, half);
      }
    }
    CHECK(work.obstacle_force.size() == (contact.empty() ? 2 : 3));
    CHECK(work.obstacle_force[0].z() < -10);
    CHECK(lifted > 10);
    CHECK(sim.body().surface.crack_count() == 1);
    set_threads(1);
    Simulation again = read_back(scene, half);
    for (int i = 4; i < 8; ++i) again.advance_frame();
    CHECK(bytes(again) == bytes(sim));
    // A run without checkpoints keeps more data of its steps than a checkpoint has, with the same
    // result.
    Simulation untouched(scene, model);
    for (int i = 0; i < 8; ++i) untouched.advance_frame();
    CHECK(bytes(untouched) == bytes(sim));
    // A run that restores itself before, during and after a cut equals new runs from these
    // checkpoints.
    Simulation kept(scene, model);
    for (int i = 0; i < 8; ++i) {
      Simulation other = read_back(scene, bytes(kept));
      Checkpoint c = read_checkpoint(KerfFile(Input(bytes(kept), "checkpoint")));
      kept.restore(std::move(c.body), std::move(c.state));
      other.advance_frame();
      kept.advance_frame();
      CHECK(bytes(kept) == bytes(other));
    }
    CHECK(kept.body().surface.crack_count() == 1);
    set_threads(0);
  }
}

TEST_CASE("obstacles that are none are refused in one line") {
  const auto refused = [](const std::string& obstacle) -> std::string {
    try {
      parse_scene("[body]\nmesh = 'a'\n[[obstacle]]\n" + obstacle, "s.toml");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(refused("friction = 1\n") ==
        "s.toml:3:1: an obstacle is a 'mesh' or the 'normal' of a plane: give one of them");
  CHECK(refused("normal = [0, 0, 1]\nmesh = 'a'\n").find("give one of them") != std::string::npos);
  CHECK(refused("normal = [0, 0, 0]\n") == "s.toml:4:10: 'obstacle.normal' has no direction");
  CHECK(refused("normal = [0, 0, nan]\n") == "s.toml:4:17: 'obstacle.normal' must be 3 finite numbers");
  CHECK(refused("normal = [0, 0, 1]\nstiffness = -1\n") ==
        "s.toml:5:13: 'obstacle.stiffness' is out of range: it must be from 0 to 1e+12");
  CHECK(refused("normal = [0, 0, 1]\nhard = 1\n") == "s.toml:5:8: unknown key 'obstacle.hard'");
  CHECK(refused("normal = [0, 0, 1]\nkeys = [[1, 0, 0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 0, 1, 0]]\n")
            .find("must ascend in time") != std::string::npos);
  CHECK(refused("mesh = 'no such file.ply'\n").find("no such file.ply") != std::string::npos);
}

TEST_CASE("a plane is shown as a square that moves with it, beside the bodies and wider than they are") {
  Scene scene = scene_of(
      "position = [3, 1, 2]\n[[obstacle]]\nnormal = [0.5, 0.2, 1]\nposition = [0, 0, -0.5]\nrotation = [1, 0, 0, "
      "20]\nscale = 2\n"
      "keys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, 0.7, 0, 0, 1, 30]]\n");
  const PlacedModels model = place_models(scene, {make_block({1, 1, 0.5}, 0.25)});
  const Box3 bodies = bounding_box(model.all);
  for (const double time : {0.0, 0.4, 2.0}) {
    const TriangleMesh shown = place_obstacles(scene, model, time);
    const Pose pose = scene.obstacles[0].pose(time);
    const Vec3 normal = pose.rotation * scene.obstacles[0].normal.normalized();
    REQUIRE(shown.vertices.size() == 4);
    REQUIRE(shown.triangles.size() == 2);
    for (const Vec3& p : shown.vertices) CHECK(std::abs((p - pose.position).dot(normal)) < 1e-12);
    CHECK(std::abs(area(shown) - std::pow(1.5 * bodies.diagonal(), 2)) < 1e-9);
    for (const auto& [a, b, c] : corners_of(shown)) CHECK((b - a).cross(c - a).normalized().dot(normal) > 1 - 1e-12);
    const Vec3 middle = bounding_box(shown).center(), away = middle - bodies.center();
    if (time == 0) CHECK((away - away.dot(normal) * normal).norm() < 1e-12);
  }
}
