#include <catch2/catch.hpp>

#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"

using namespace geo;

TEST_CASE("a body that a sheet has scored begins in pieces") {
  // Two planes in one sheet, which cross inside of the cube.
  Front sheet{"cells",
              false,
              {{{-1, -1, 0.43}, {3, -1, 0.45}, {-1, 3, 0.52}, {0.41, -1, -1}, {0.44, 3, -1}, {0.55, -1, 3}}},
              {{0, 1, 2}, {3, 4, 5}}};
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.2;
  scene.scores = {{sheet}};
  scene.gravity = {0, 0, -2};
  Simulation sim(scene, make_block({1, 1, 1}, 0.2));
  const Body& body = sim.body();
  CHECK(check_complex(body.surface, SelfIntersections::find).good());
  CHECK(find_pieces(body.surface).count == 4);
  std::vector<std::uint32_t> component;
  CHECK(body.graph.components(component) == 4);
  CHECK(check_body(body).first_problem == "");
  sim.advance_frame();
  // All fall alike: no bond is left, and none pulls another.
  const auto& u = sim.state().motion.displacement;
  for (const Vec3& d : u) CHECK(d.z() == Approx(u[0].z()).epsilon(1e-3));
  CHECK(u[0].z() < 0);
}
