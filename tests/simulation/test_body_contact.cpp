// Deforming bodies of one scene that meet each other.
#include <catch2/catch.hpp>
#include <cmath>

#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

struct Middle {
  double mass = 0;
  Vec3 place = Vec3::Zero(), momentum = Vec3::Zero(), turning = Vec3::Zero();
};
// Mass, centre, momentum and angular momentum (about the origin) of one body of the scene, or of
// all.
Middle middle_of(const Simulation& sim, int part) {
  Middle m;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    if (part >= 0 && sim.state().body_index[i] != std::uint32_t(part)) continue;
    const double mass = sim.solid().mass(NodeId(i));
    const Vec3 x = sim.body().nodes.position[i] + sim.state().motion.displacement[i],
               v = sim.state().motion.velocity[i];
    m.mass += mass;
    m.place += mass * x;
    m.momentum += mass * v;
    m.turning += mass * x.cross(v);
  }
  m.place /= m.mass;
  return m;
}

std::string two_bodies(const std::string& first, const std::string& second) {
  return "[[body]]\nmesh = 'a'\nspacing = 0.25\n" + first + "[[body]]\nmesh = 'b'\nspacing = 0.25\n" + second;
}

}  // namespace

TEST_CASE("of two blocks, one on the other, each carries what is above it") {
  const Scene scene =
      parse_scene(two_bodies("", "position = [0.11, 0.13, 0.501]\n") +
                      "[material]\nyoung = 2e5\ndamping = 6\n[time]\nframes = 24\nframe_rate = 20\nstep = 0.025\n"
                      "[[obstacle]]\nnormal = [0, 0, 1]\nstiffness = 2e4\n",
                  "s.toml");
  Simulation sim(scene, place_models(scene, {make_block({1, 1, 0.5}, 0.125), make_block({0.8, 0.8, 0.5}, 0.125)}));
  FrameStats work;
  for (int i = 0; i < 24; ++i) work = sim.advance_frame();
  const Middle lower = middle_of(sim, 0), upper = middle_of(sim, 1);
  CHECK(-work.obstacle_force.at(0).z() == Approx(9.81 * (lower.mass + upper.mass)).epsilon(0.01));
  // The penalty yields by g / stiffness times the number of layers, the blocks by their own weight.
  CHECK(upper.place.z() - lower.place.z() == Approx(0.5).margin(0.025));
  CHECK((upper.momentum / upper.mass).norm() < 0.01);
  CHECK((upper.place - lower.place).head<2>().norm() ==
        Approx(Vec2(0.01, 0.03).norm()).margin(0.005));  // friction holds it
}

TEST_CASE("bodies that collide keep their momentum, and part again") {
  for (const std::string integrator : {"implicit", "leapfrog"}) {
    INFO(integrator);
    const Scene scene = parse_scene(
        "gravity = [0, 0, 0]\n" +
            two_bodies("velocity = [1, 0, 0]\n", "velocity = [-1, 0.2, 0]\nposition = [1.05, 0.23, 0.11]\n") +
            "[material]\nyoung = 1e5\ndamping = 0\n[time]\nframes = 16\nframe_rate = 40\nstep = 0.0125\naccuracy = "
            "1e-6\nintegrator = '" +
            integrator + "'\n",
        "s.toml");
    Simulation sim(scene, place_models(scene, {make_block({1, 1, 1}, 0.125), make_block({1, 0.7, 0.8}, 0.125)}));
    const Middle before = middle_of(sim, -1);
    double nearest = 1e300;
    for (int i = 0; i < 16; ++i) {
      sim.advance_frame();
      nearest = std::min(nearest, middle_of(sim, 1).place.x() - middle_of(sim, 0).place.x());
    }
    const Middle after = middle_of(sim, -1), left = middle_of(sim, 0), right = middle_of(sim, 1);
    const double size = left.mass + right.mass;  // at a metre a second
    CHECK((after.momentum - before.momentum).norm() < (integrator == "implicit" ? 5e-4 : 1e-12) * size);
    CHECK((after.turning - before.turning).norm() < 0.01 * size);  // the two sides' forces act a depth apart
    CHECK(nearest > 0.75);
    CHECK(left.momentum.x() < 0);
    CHECK(right.momentum.x() > 0);
  }
}

TEST_CASE(
    "a body that lies on another is cut, and that one with it: the same with any threads and after a checkpoint") {
  const Scene scene =
      parse_scene(two_bodies("", "position = [0.11, 0.13, 0.501]\n") +
                      "[material]\nyoung = 5e4\n[time]\nframes = 8\nframe_rate = 20\nstep = 0.025\n"
                      "[[obstacle]]\nnormal = [0, 0, 1]\n[[blade]]\npoints = [[-0.2, 0, 0], [1.2, 0, 0]]\ndivide = 8\n"
                      "keys = [[0.0, 0.013, 0.507, 1.2, 0, 0, 1, 2], [0.3, 0.013, 0.511, 0.2, 0, 0, 1, 3]]\n",
                  "s.toml");
  const PlacedModels model = place_models(scene, {make_block({1, 1, 0.5}, 0.25), make_block({0.8, 0.8, 0.5}, 0.2)});
  set_threads(2);
  Simulation sim(scene, model);
  std::string half;
  for (int i = 0; i < 8; ++i) {
    sim.advance_frame();
    if (i != 3) continue;
    half = bytes(sim);
    sim = read_back(scene, half);
  }
  CHECK(sim.body().surface.crack_count() >= 1);
  CHECK(middle_of(sim, 1).place.z() - middle_of(sim, 0).place.z() > 0.4);
  set_threads(1);
  Simulation again = read_back(scene, half);
  for (int i = 4; i < 8; ++i) again.advance_frame();
  CHECK(bytes(again) == bytes(sim));
  set_threads(0);
}
