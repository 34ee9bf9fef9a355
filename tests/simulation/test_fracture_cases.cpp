// Fracture of random bodies: all invariants after every frame, and the same bytes for other numbers
// of threads and after a checkpoint.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

struct RandomCase {
  Scene scene;
  TriangleMesh mesh;
  Mat3 gradient;
};

// A model, a stretch that varies through it, and settings under which several cracks begin, divide
// and meet.
RandomCase random_case(std::uint64_t seed) {
  Random random(seed);
  RandomCase c;
  const auto kind = random.below(3);
  c.mesh = kind == 0 ? make_block({1.5, 1, 0.5}, 0.25) : kind == 1 ? make_sphere(6) : make_pumpkin(8);
  Scene& s = c.scene;
  s.gravity.setZero();
  s.bodies.resize(1);
  SceneBody& body = s.bodies[0];
  body.sampling.count = 300 + random.below(100);
  s.material.young = 1e6;
  s.material.damping = random.uniform(0.0, 40.0);
  s.material.poisson = random.uniform(0.0, 0.4);
  body.spin = 30 * random.direction();
  s.seed = s.fracture.seed = seed;
  s.frame_rate = 200;
  s.dt = 1.0 / 200;
  s.fracture.on = true;
  s.fracture.strength = random.uniform(3e3, 2e4);
  s.fracture.variation = random.uniform(0.0, 0.6);
  s.fracture.branching = random.below(3) ? 1.05 : 0;
  s.fracture.max_cracks = 12;
  s.fracture.cracks_per_step = 2;
  s.fracture.separation = random.uniform(1.0, 2.0);
  for (int i = 0; i < 9; ++i) c.gradient.data()[i] = random.uniform(-0.02, 0.04);
  return c;
}

Simulation begin(const RandomCase& c) {
  Simulation fresh(c.scene, c.mesh);
  RunState state = fresh.state();
  const Box3 box = bounding_box(c.mesh);
  for (std::size_t i = 0; i < fresh.body().nodes.size(); ++i) {
    const Vec3 x = fresh.body().nodes.position[i] - box.center();
    state.motion.displacement[i] = c.gradient * x * (1 + x.x());
  }
  return Simulation(c.scene, fresh.body(), state);
}

}  // namespace

TEST_CASE("random bodies break and keep every invariant, the same with any threads and after a checkpoint",
          "[fracture]") {
  const auto [first, count] = seeds(4);
  std::size_t begun = 0, divided = 0, advanced = 0;
  const int frames = 10;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    const RandomCase c = random_case(seed);
    set_threads(2);
    Simulation sim = begin(c);
    std::string half;
    FrameStats work;
    for (int i = 0; i < frames; ++i) {
      work += sim.advance_frame();
      INFO("KERF_CASE=" << seed << ", frame " << i);
      REQUIRE(check_body(sim.body()).first_problem == "");
      REQUIRE(check_complex(sim.body().surface, SelfIntersections::find).good());
      double volume = 0;
      for (const double v : sim.body().nodes.volume) volume += v;
      REQUIRE(volume == Approx(signed_volume(c.mesh)).epsilon(1e-9));
      if (i + 1 == frames / 2) half = bytes(sim);
      // A body that is read back has its ids in another order: from here on both go on from the
      // file.
      if (i + 1 == frames / 2) sim = read_back(c.scene, half);
    }
    begun += work.fracture.begun;
    divided += work.fracture.divided;
    advanced += work.fracture.advanced;
    set_threads(1);
    Simulation again = read_back(c.scene, half);
    for (int i = frames / 2; i < frames; ++i) again.advance_frame();
    INFO("KERF_CASE=" << seed);
    CHECK(again.state().fracture.fronts.size() == sim.state().fracture.fronts.size());
    CHECK(bytes(again) == bytes(sim));
    set_threads(0);
  }
  CHECK(begun > 0);
  CHECK(divided > 0);
  CHECK(advanced > 20);
}
