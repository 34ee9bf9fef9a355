// Motion by keyframes, strength of materials, grips, and the fronts of edges.
#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>
#include <sstream>

#include "base/random.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "simulation/edge_front.h"
#include "simulation/grips.h"
#include "simulation/strength.h"

using namespace geo;

TEST_CASE("a motion interpolates positions linearly and rotations by angle or spherically", "[scene]") {
  Motion motion;
  CHECK_FALSE(motion.active(0));
  CHECK(motion.at(3).position == Vec3::Zero());
  motion.keys = {{1, {0, 0, 0}, {0, 0, 1}, 0}, {3, {2, 0, 4}, {0, 0, 1}, 720}};
  CHECK_FALSE(motion.active(0.9));
  CHECK(motion.active(1));
  CHECK(motion.active(3));
  CHECK_FALSE(motion.active(3.1));
  // Half way: one whole turn, which spherical interpolation would not make.
  const Pose half = motion.at(2);
  CHECK((half.position - Vec3(1, 0, 2)).norm() < 1e-15);
  CHECK((half * Vec3(1, 0, 0) - Vec3(2, 0, 2)).norm() < 1e-12);
  const Pose eighth = motion.at(1.25);  // a quarter turn
  CHECK((eighth.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm() < 1e-12);
  CHECK((motion.at(-5).position - Vec3(0, 0, 0)).norm() == 0);
  CHECK((motion.at(9).position - Vec3(2, 0, 4)).norm() == 0);
  // Different axes: half way between no rotation and 90° about x is 45° about x.
  motion.keys[1] = {3, {0, 0, 0}, {1, 0, 0}, 90};
  const double s = std::sqrt(0.5);
  CHECK((motion.at(2).rotation * Vec3(0, 1, 0) - Vec3(0, s, s)).norm() < 1e-12);
}

TEST_CASE("strength: noise is bounded and repeatable, boxes exclude fracture, speeds are Freund's", "[scene]") {
  Strength strength;
  strength.variation = 0.5;
  Random random(7);
  double least = 1e300, largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double factor = strength_factor(strength, 3, 2, x);
    REQUIRE(factor == strength_factor(strength, 3, 2, x));
    least = std::min(least, factor);
    largest = std::max(largest, factor);
  }
  CHECK(least >= 0.05);
  CHECK(least < 0.9);
  CHECK(largest > 1.1);
  CHECK(largest < 1.8);
  strength.variation = 0;
  CHECK(strength_factor(strength, 3, 2, {0.1, 0.2, 0.3}) == 1);

  FractureOptions fracture;
  CHECK(may_break(fracture, {0, 0, 0}));
  fracture.off.push_back({Vec3(-1, -1, -1), Vec3(0, 1, 1)});
  CHECK_FALSE(may_break(fracture, {0, 0, 0}));  // the border belongs to the box
  CHECK(may_break(fracture, {1e-9, 0, 0}));
  fracture.per_body = {Breakage{{1, 2, 0, 0}}, Breakage{{3, 4, 0, 0}}};
  CHECK(fracture.at_node({0, 1, 1}, 2).toughness == 4);

  Material material;
  material.young = 2.5e9;
  material.poisson = 0.25;
  material.density = 1000;  // μ = 1e9, c_s = 1000 m/s
  CHECK(rayleigh_speed(material) == Approx(1000 * (0.862 + 1.14 * 0.25) / 1.25));
  // The mean of K / √(2πr) over 0 < r < h, by the midpoint rule in √r.
  const double h = 0.3;
  double mean = 0;
  for (int i = 0; i < 1000; ++i) {
    const double root = (i + 0.5) / 1000 * std::sqrt(h), r = root * root;
    mean += 2 / std::sqrt(2 * std::numbers::pi * r) * 2 * root * std::sqrt(h) / 1000 / h;
  }
  CHECK(stress_of_toughness(2, h) == Approx(mean).epsilon(1e-9));
}

TEST_CASE("grips hold the nodes in their boxes, move them, and release them", "[scene]") {
  NodeSet nodes;
  nodes.position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
  std::vector<Grip> grips(2);
  grips[0].lo = {-0.5, -1, -1};
  grips[0].hi = {1.5, 1, 1};
  grips[0].motion.keys = {{0, {0, 0, 0}, {0, 0, 1}, 0}, {1, {0, 0, 2}, {0, 0, 1}, 90}};
  grips[0].release = true;
  grips[1].lo = {0.5, -1, -1};
  grips[1].hi = {2.5, 1, 1};  // node 1 is in both: the first holds it
  const GrippedNodes gripped(grips, nodes);
  State state;
  state.displacement.assign(4, Vec3(7, 7, 7));
  state.velocity.assign(4, Vec3(8, 8, 8));
  std::vector<std::uint8_t> fixed(4, 1);
  gripped.place(grips, nodes, 1, fixed, state);
  CHECK(fixed == std::vector<std::uint8_t>{1, 1, 1, 0});
  // A quarter turn about the centre (0.5, 0, 0) of the box, and 2 upwards.
  CHECK((state.displacement[0] - (Vec3(0.5, -0.5, 2) - Vec3(0, 0, 0))).norm() < 1e-12);
  CHECK((state.displacement[1] - (Vec3(0.5, 0.5, 2) - Vec3(1, 0, 0))).norm() < 1e-12);
  CHECK(state.displacement[2] == Vec3(7, 7, 7));  // held where it is
  gripped.set_velocities(grips, nodes, 0, 1, state);
  CHECK((state.velocity[0] - Vec3(0.5, -0.5, 2)).norm() < 1e-12);
  CHECK(state.velocity[2] == Vec3(8, 8, 8));
  gripped.place(grips, nodes, 1.5, fixed, state);
  CHECK(fixed == std::vector<std::uint8_t>{0, 0, 1, 0});
  // Material follows a box that moves, or that holds from the start; the released one keeps node 1.
  grips.push_back({{4, -1, -1}, {6, 1, 1}, {}, false, 1.2});
  const auto boxes = GrippedNodes::boxes(grips, 1.5);
  REQUIRE(boxes.size() == 3);
  CHECK((!boxes[0].rigid && boxes[1].rigid && !boxes[2].rigid));
  CHECK((GrippedNodes::boxes(grips, 1).size() == 2 && GrippedNodes::boxes(grips, 1)[0].rigid));
}

TEST_CASE("edge fronts are refined, collapsed, split and joined by their parameters", "[scene]") {
  const auto point = [](double at, double x) { return EdgePoint{at, Vec3(x, 0, 0), 1}; };
  const std::vector<EdgePoint> first{point(0, 0), point(1, 1), point(2, 2)};
  const EdgeFront edge = begin_edge(first, 4, "blade");
  REQUIRE(edge.at == std::vector<double>{0, 1, 2});
  CHECK(edge.front.crack == 4);
  CHECK(edge.front.segments.size() == 2);

  // Upsampling at 1.25, next to point 1; downsampling of point 2, whose nearest parameter is 1.25.
  const std::vector<EdgePoint> next{point(0, 10), point(1, 11), point(1.25, 11.25)};
  std::vector<Vec3> to;
  EdgeFront moved = refined(edge, next, to);
  REQUIRE(moved.at == std::vector<double>{0, 1, 1.25, 2});
  CHECK(moved.front.points[2].position == Vec3(1, 0, 0));  // starts at its neighbour
  REQUIRE(to.size() == 4);
  CHECK(to[2] == Vec3(11.25, 0, 0));
  CHECK(to[3] == to[2]);
  CHECK(moved.front.segments.size() == 3);

  for (std::size_t i = 0; i < to.size(); ++i) moved.front.points[i].position = to[i];
  collapse(moved, next);
  CHECK(moved.at == std::vector<double>{0, 1, 1.25});
  CHECK(moved.front.segments.size() == 2);

  CHECK(part_of(edge, 0.5, 0.9).at.empty());
  const EdgeFront low = part_of(edge, -1, 1), high = part_of(edge, 1, 5);
  REQUIRE(low.at == std::vector<double>{0, 1});
  REQUIRE(high.at == std::vector<double>{1, 2});
  const EdgeFront both = joined(low, high);
  CHECK(both.at == std::vector<double>{0, 1, 1, 2});
  CHECK(both.front.segments.size() == both.front.points.size() - 1);
}

TEST_CASE("keys of the former contact between bodies are read where they mean what they meant") {
  const auto refused = [](const std::string& contact) -> std::string {
    try {
      parse_scene("[body]\nmesh = 'a'\n[contact]\n" + contact, "s.toml");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(parse_scene("[body]\nmesh = 'a'\n", "s.toml").self_contact);
  for (const char* same : {"self = true\nbodies = false\n", "self = true\nstiffness = 1e5\n", "bodies = true\n",
                           "stiffness = 1e4\n", "self = false\nbodies = false\nstiffness = 1e5\n"})
    CHECK(refused(same) == "");
  CHECK(refused("bodies = false\n") ==
        "s.toml:4:10: for bodies that do not touch each other, write 'contact.self' = false");
  CHECK(refused("self = false\nbodies = true\n") ==
        "s.toml:5:10: for bodies that touch each other, write 'contact.self' = true");
  CHECK(refused("self = false\nstiffness = 1e4\n").find("write 'contact.self' = true") != std::string::npos);
  // The remedies are read.
  CHECK_FALSE(parse_scene("[body]\nmesh = 'a'\n[contact]\nself = false\n", "s.toml").self_contact);
  CHECK(parse_scene("[body]\nmesh = 'a'\n[contact]\nself = true\n", "s.toml").self_contact);
}

TEST_CASE("a skin is refined after its model is scaled and placed, body by body, and keeps its volume") {
  const Scene scene = parse_scene(
      "[[body]]\nmesh = 'a'\nscale = 2\nposition = [5, 0, 0]\nrefine = 0.3\n[[body]]\nmesh = 'b'\n", "s.toml");
  const TriangleMesh block = make_block({1, 1, 1}, 1);
  const PlacedModels models = place_models(scene, {block, block});
  const TriangleMesh& fine = models.bodies[0];
  double longest = 0;
  for (const Triangle& t : fine.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (fine.vertices[t[k]] - fine.vertices[t[(k + 1) % 3]]).norm());
  CHECK(longest <= 0.3);
  CHECK(longest > 0.15);
  CHECK(signed_volume(fine) == Approx(8).epsilon(1e-12));
  CHECK(bounding_box(fine).lo == Vec3(5, 0, 0));
  CHECK(models.bodies[1].triangles == block.triangles);
  CHECK(models.bodies[1].vertices == block.vertices);

  std::ostringstream written;
  write_scene(written, scene, "");
  const Scene read = parse_scene(written.str(), "t.toml");
  CHECK(read.bodies[0].refine == 0.3);
  CHECK(read.bodies[1].refine == 0);
  CHECK_THROWS_AS(parse_scene("[body]\nmesh = 'a'\nrefine = -1\n", "s.toml"), InputError);
}
