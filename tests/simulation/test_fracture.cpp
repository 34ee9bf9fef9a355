// Bodies that break by their own stress.
#include <catch2/catch.hpp>

#include "cases.h"
#include "simulation/notched_block.h"
#include "simulation/simulation.h"
#include "surface/check.h"
#include "surface/pieces.h"

using namespace geo;

namespace {

Scene brittle() {
  Scene s;
  s.gravity.setZero();
  s.bodies.resize(1);
  Material& m = s.bodies[0].material;
  m.young = 1e6, m.poisson = 0.25, m.density = 1000, m.damping = 20;
  s.fracture.on = true;
  s.fracture.strength = 1e4, s.fracture.variation = 0;
  s.frame_rate = 200, s.dt = 1.0 / 200;
  return s;
}

// A notched block that is held at y = 0 and y = height in the shape that a uniform gradient gives it.
Simulation gripped(const Scene& scene, Notched n, const Mat3& gradient) {
  RunState state;
  for (const Vec3& x : n.body.nodes.position) state.motion.displacement.push_back(gradient * x);
  state.motion.velocity.assign(n.body.nodes.size(), Vec3::Zero());
  state.fracture.fronts.push_back(std::move(n.front));
  state.fracture.cracks = 1;
  return Simulation(scene, std::move(n.body), std::move(state));
}

}  // namespace

TEST_CASE("mode I: a notch in tension runs straight through and parts the plate", "[fracture]") {
  const auto seed = GENERATE(1, 2);
  Scene scene = brittle();
  scene.grips = {{Vec3(-1, -1, -1), Vec3(2, 0.08, 1), {}, false}, {Vec3(-1, 0.92, -1), Vec3(2, 2, 1), {}, false}};
  scene.fracture.cracks = 0;
  Simulation sim = gripped(scene, notched_block({1, 1, 0.16}, 0.06, 0.31, 0.507, static_cast<std::uint64_t>(seed)), 0.02 * Vec3::UnitY() * Vec3::UnitY().transpose());
  FrameWork work;
  double before = sim.solid().energy(sim.state().motion.displacement);
  for (int i = 0; i < 60 && !sim.state().fracture.fronts.empty(); ++i) work += sim.advance_frame();
  INFO("seed " << seed);
  CHECK(work.refused == 0);
  CHECK(sim.solid().energy(sim.state().motion.displacement) < 0.5 * before);
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK(check_body(sim.body()).first_problem == "");
  double worst = 0;
  const Complex& k = sim.body().surface;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f)) && k.face(FaceId(f)).crack > 0)
      for (const Vec3& p : k.corners(FaceId(f))) worst = std::max(worst, std::abs(p.y() - 0.507));
  CHECK(worst < 0.06);
}
