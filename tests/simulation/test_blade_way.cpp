// Sheets of blades are as smooth as the motion of blade and material, however they move.
#include <catch2/catch.hpp>

#include "kerf/check.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/edge_retreat.h"

using namespace geo;

namespace {

// A block of 1 × 1 × 1, spacing 0.25, and a blade with these keys.
Scene scene_of(const std::string& body, const std::string& keys, const std::string& limit) {
  return parse_scene("gravity = [0, 0, 0]\n[time]\nframe_rate = 4\nstep = 0.05\n[body]\nmesh = 'a'\nspacing = 0.25\n" +
                         body + "\n[[blade]]\npoints = [[-0.3, 0, 0], [1.3, 0.01, 0.013]]\ndivide = 7\nlimit = " +
                         limit + "\nkeys = [" + keys + "]\n",
                     "s.toml");
}

FrameStats run(Simulation& sim, int frames) {
  FrameStats work;
  for (int i = 0; i < frames; ++i) work += sim.advance_frame();
  CHECK(work.refused == 0);
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  return work;
}

double crack_area(const Complex& surface) {
  double area = 0;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (surface.alive(FaceId(f)) && surface.face(FaceId(f)).crack > 0) {
      const auto [a, b, c] = surface.corners(FaceId(f));
      area += 0.5 * (b - a).cross(c - a).norm();
    }
  return area;
}

}  // namespace

TEST_CASE("a body that falls before its blade is cut by one plane") {
  // The blade is faster by a fifth, and each of its cuts moves it by less than the body falls.
  Simulation sim(
      scene_of("velocity = [0, 0, -2]", "[0, 0, 0.507, 1.2, 0, 0, 1, 0], [4, 0, 0.507, -8.8, 0, 0, 1, 0]", "0.1"),
      make_block({1, 1, 1}, 0.2));
  const FrameStats work = run(sim, 14);
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK(work.sheet.retreating == 0);
  CHECK(work.sheet.deviation < 1e-3);
  CHECK(work.sheet.turning < 0.1);
  CHECK(work.sheet.crumbs == 0);
}

TEST_CASE("a blade that goes back in its cut cuts nothing") {
  const auto cut = [](const std::string& keys) {
    Simulation sim(scene_of("", keys, "0.5"), make_block({1, 1, 1}, 0.2));
    const FrameStats work = run(sim, 6);
    CHECK(find_pieces(sim.body().surface).count == 2);
    CHECK(work.sheet.crumbs == 0);
    CHECK(work.sheet.turning < 1e-3);
    return std::pair(crack_area(sim.body().surface), work.sheet.retreating);
  };
  const auto [once, none] = cut("[0, 0, 0.507, 1.2, 0, 0, 1, 0], [1.4, 0, 0.507, -0.4, 0, 0, 1, 0]");
  const auto [again, held] =
      cut("[0, 0, 0.507, 1.2, 0, 0, 1, 0], [0.4, 0, 0.507, 0.4, 0, 0, 1, 0], [0.6, 0, 0.507, 0.83, 0, 0, 1, 0], "
          "[1.4, 0, 0.507, -0.4, 0, 0, 1, 0]");
  CHECK(none == 0);
  CHECK(held > 0);
  CHECK(once == Approx(1).epsilon(1e-3));
  CHECK(again == Approx(once).epsilon(1e-6));
}

TEST_CASE("a blade that is pulled out of its cut leaves it as it is") {
  Simulation sim(scene_of("",
                          "[0, 0, 0.507, 1.2, 0, 0, 1, 0], [0.4, 0, 0.507, 0.4, 0, 0, 1, 0], "
                          "[0.8, 0, 0.507, 1.5, 0, 0, 1, 0]",
                          "0.5"),
                 make_block({1, 1, 1}, 0.2));
  const FrameStats work = run(sim, 4);
  CHECK(work.sheet.retreating > 0);
  CHECK(work.sheet.crumbs == 0);
  CHECK(find_pieces(sim.body().surface).count == 1);
  CHECK(crack_area(sim.body().surface) == Approx(0.6).epsilon(0.02));
}

TEST_CASE("a blade that jumps in one step has cut what it passed") {
  const auto area = [](double end, bool is_divided) {
    Scene scene =
        scene_of("", "[0, 0, 0.507, 4, 0, 0, 1, 0], [0.05, 0, 0.507, " + std::to_string(end) + ", 0, 0, 1, 0]", "0.5");
    auto& points = scene.blades[0].points;
    if (!is_divided) points = {points.front(), points.back()};  // both beside the body
    Simulation sim(scene, make_block({1, 1, 1}, 0.2));
    run(sim, 1);
    return crack_area(sim.body().surface);
  };
  for (const bool is_divided : {true, false}) {
    CHECK(area(-3, is_divided) == Approx(1).epsilon(1e-3));  // over the body
    CHECK(area(0.4, is_divided) == Approx(0.6).epsilon(0.02));
  }
}

TEST_CASE("an edge at rest in material that creeps across it cuts seldom, and is never far from its front") {
  constexpr double spacing = 0.25;
  Scene scene = scene_of("velocity = [0, -0.06, 0]",
                         "[0, 0, 0.507, 1.2, 0, 0, 1, 0], [0.4, 0, 0.507, 0.4, 0, 0, 1, 0], "
                         "[4.4, 0, 0.507, 0.4, 0, 0, 1, 0]",
                         "0.5");
  scene.material.damping = 0.5;
  Simulation sim(scene, make_block({1, 1, 1}, 0.2));
  run(sim, 2);
  const FrameStats work = run(sim, 14);
  CHECK(work.fronts > 3);
  CHECK(work.fronts <= 8);  // of 70 time steps
  const double crept = -sim.state().motion.displacement[0].y();
  CHECK(crept > 0.2 * spacing);
  REQUIRE(sim.state().fronts[0].size() == 1);
  for (const auto& p : sim.state().fronts[0][0].front.points) {
    INFO("front point " << p.position.transpose());
    const double along = (p.position.x() + 0.3) / 1.6;  // of the blade
    CHECK(std::abs(p.position.y() - (0.507 + 0.01 * along + crept)) < 0.06 * spacing);
    CHECK(std::abs(p.position.z() - (0.4 + 0.013 * along)) < 0.06 * spacing);
  }
}

TEST_CASE("a blade that turns by an acute angle cuts on") {
  Simulation sim(scene_of("",
                          "[0, 0, 0.407, 1.2, 0, 0, 1, 0], [0.4, 0, 0.403, 0.4, 0, 0, 1, 0], "
                          "[0.8, 0, 0.853, 1.3, 0, 0, 1, 0]",
                          "0.5"),
                 make_block({1, 1, 1}, 0.2));
  const FrameStats work = run(sim, 4);
  CHECK(work.sheet.crumbs == 0);
  CHECK(find_pieces(sim.body().surface).count == 2);  // a wedge came off
  CHECK(crack_area(sim.body().surface) == Approx(0.6 + std::hypot(0.6, 0.3)).epsilon(0.03));
}

TEST_CASE("a sheet in falling material is as smooth with more nodes, and there are no crumbs") {
  // Neo-Hookean, since St. Venant-Kirchhoff material as soft as this collapses under its own
  // weight (docs/decisions/086).
  for (const double spacing : {0.25, 0.18, 0.12}) {
    INFO("spacing " << spacing);
    const Scene scene = parse_scene(
        "gravity = [0, 0, -9.81]\n[body]\nmesh = 'a'\nspacing = " + std::to_string(spacing) +
            "\n[material]\nmodel = 'neo-hookean'\nyoung = 5e4\nvolume_term = 5e4\ndamping = 1.0\n[ground]\npoint = [0, "
            "0, -0.05]\nstiffness = 1e4\n[contact]\n"
            "self = true\n[time]\nframe_rate = 24\nstep = 0.021\n[[blade]]\npoints = [[-0.4, 0, 0], [1.4, 0, 0]]\n"
            "divide = 6\nkeys = [[0.0, 0.013, 0.457, 1.3, 0, 0, 1, 2], [0.5, 0.013, 0.551, -0.4, 0, 0, 1, 9]]\n",
        "s.toml");
    Simulation sim(scene, make_block({1, 1, 1}, 0.6 * spacing));
    FrameStats work;
    for (int i = 0; i < 12; ++i) {
      work += sim.advance_frame();
      CHECK(count_crossings(sim.surface()) == 0);
    }
    CHECK(find_pieces(sim.body().surface).count == 2);
    CHECK(work.refused == 0);
    CHECK(work.sheet.deviation < 0.05);  // 0.07 where the edge does not go on from its front
    CHECK(work.sheet.turning < 10);
    CHECK(work.sheet.retreating == 0);
    CHECK(work.sheet.crumbs == 0);
  }
}
