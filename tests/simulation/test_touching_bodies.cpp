// Bodies that touch when they are placed: they are moved apart by a gap; those that overlap are
// refused.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/simulation.h"

using namespace geo;

namespace {

struct Placed {
  TriangleMesh mesh;
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

Scene scene_of(const std::vector<Placed>& bodies) {
  Scene scene;
  for (const Placed& placed : bodies) {
    SceneBody body;
    body.mesh = "box" + std::to_string(scene.bodies.size()) + ".ply";
    body.place.position = placed.position;
    body.place.rotation = placed.rotation;
    scene.bodies.push_back(body);
  }
  return scene;
}

PlacedModels place(const std::vector<Placed>& bodies) {
  std::vector<TriangleMesh> meshes;
  for (const Placed& placed : bodies) meshes.push_back(placed.mesh);
  return place_models(scene_of(bodies), std::move(meshes));
}

std::string refusal(const std::vector<Placed>& bodies) {
  try {
    place(bodies);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TriangleMesh box(const Vec3& size, double edge = 1) { return make_block(size, edge); }

Eigen::Quaterniond on_corner() { return Eigen::Quaterniond::FromTwoVectors(Vec3(1, 1, 1), Vec3(0, 0, 1)); }

// The bodies touch as they are given; placed, they do not, and nothing has moved by more than a few
// gaps.
void check_parted(const std::vector<Placed>& bodies, std::size_t pairs) {
  const PlacedModels models = place(bodies);
  CHECK(models.touching.size() == pairs);
  CHECK(check_surface(models.all, SelfIntersections::find).first_problem == "");
  const Scene scene = scene_of(bodies);
  std::size_t at = 0;
  double farthest = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t v = 0; v < bodies[b].mesh.vertices.size(); ++v, ++at) {
      CHECK(models.bodies[b].vertices[v] == models.all.vertices[at]);
      farthest =
          std::max(farthest, (models.all.vertices[at] - scene.bodies[b].place * bodies[b].mesh.vertices[v]).norm());
    }
  CHECK(farthest > 0);
  CHECK(farthest < 8 * models.gap);
  CHECK(models.gap < 1e-3);
  CHECK_THAT(touching_note(scene, models), Catch::Contains("touch"));
}

}  // namespace

TEST_CASE("bodies that touch in faces, edges, corners, and in no vertex are parted by a gap") {
  const TriangleMesh cube = box({1, 1, 1}), fine = box({1, 1, 1}, 0.3);
  check_parted({{cube}, {cube, {0, 0, 1}}}, 1);
  check_parted({{cube}, {fine, {0, 0, 1}}, {cube, {0.2, 0.3, 2}}}, 2);
  check_parted({{fine}, {fine, {1, 0, 0}}, {cube, {0, 1, 0}}, {cube, {1, 1, 0}}}, 6);
  check_parted({{cube}, {cube, {1, 0, 1}}}, 1);
  check_parted({{cube}, {cube, {1, 1, 1}}}, 1);
  check_parted({{box({4, 1, 1}, 4)}, {box({1, 4, 1}, 4), {1.5, -1.5, 1}}}, 1);
  check_parted({{box({6, 6, 1}, 6)}, {cube, {3, 3, 1}, on_corner()}}, 1);
  check_parted({{box({6, 6, 1}, 6)}, {cube, {3, 3, 1}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()))}},
               1);
}

TEST_CASE("bodies apart are placed as they are, to the bit") {
  const TriangleMesh cube = box({1, 1, 1});
  const PlacedModels models = place({{cube}, {cube, {0, 0, 1.0001}}});
  CHECK(models.touching.empty());
  CHECK(models.bodies[0].vertices == cube.vertices);
  CHECK(touching_note(scene_of({{cube}, {cube}}), models) == "");
}

TEST_CASE("boxes stacked at any place, of any size and rotation, touch but for rounding and are parted") {
  const auto [first, count] = seeds(40);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Eigen::Quaterniond turned(
        Eigen::AngleAxisd(random.uniform(0, 3), Vec3(random.uniform(), random.uniform(), 1).normalized()));
    Vec3 at(random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(-100, 100));
    const double size = std::exp(random.uniform(-3, 3));
    std::vector<Placed> bodies;
    for (int i = 0; i < 4; ++i) {
      const double height = size * random.uniform(0.3, 1.5);
      bodies.push_back(
          {box({size, size * random.uniform(0.4, 1.5), height}, size * random.uniform(0.3, 1)), at, turned});
      at += turned * Vec3(size * random.uniform(-0.2, 0.2), size * random.uniform(-0.2, 0.2), height);
    }
    const PlacedModels models = place(bodies);
    CHECK(models.touching.size() == 3);
    CHECK(check_surface(models.all, SelfIntersections::find).first_problem == "");
  }
}

TEST_CASE("bodies that overlap are refused by name and depth, and so are bodies in the material of others") {
  const TriangleMesh cube = box({1, 1, 1}), fine = box({1, 1, 1}, 0.3);
  CHECK_THAT(refusal({{cube}, {cube, {5, 0, 0}}, {fine, {5, 0, 0.9}}}),
             Catch::Contains("body 2 (box1.ply) and body 3 (box2.ply) overlap, about 0.1 deep"));
  CHECK_THAT(refusal({{cube}, {cube, {0, 0, 0.99}}}), Catch::Contains("overlap, about 0.01 deep"));
  CHECK_THAT(refusal({{box({4, 1, 1}, 4)}, {box({1, 4, 1}, 4), {1.5, -1.5, 0.9}}}), Catch::Contains("about 0.1 deep"));
  CHECK_THAT(refusal({{cube}, {cube}}), Catch::Contains("overlap, about 0.9") || Catch::Contains("overlap, about 1 "));
  CHECK_THAT(refusal({{box({5, 5, 5}, 5)}, {cube, {1, 1, 1}}}), Catch::Contains("overlap, about 2 deep"));
}

TEST_CASE("a body in the cavity of another one is neither in its material nor touches it") {
  TriangleMesh hollow = box({3, 3, 3}, 3);
  const TriangleMesh cavity = box({2, 2, 2}, 2);
  const auto first = static_cast<std::uint32_t>(hollow.vertices.size());
  for (const Vec3& p : cavity.vertices) hollow.vertices.push_back(p + Vec3::Constant(0.5));
  for (const auto& [a, b, c] : cavity.triangles) hollow.triangles.push_back({a + first, c + first, b + first});
  CHECK(refusal({{hollow}, {box({1, 1, 1}), {1, 1, 1}}}) == "");
  check_parted({{hollow}, {box({1, 1, 1}), {1, 1, 0.5}}}, 1);
}

TEST_CASE("a stack that touches stands: it rests on itself without a crossing, as one with a gap does") {
  for (const double gap : {0.0, 1e-4}) {
    CAPTURE(gap);
    std::string text =
        "gravity = [0, 0, -9.81]\n[material]\nyoung = 1e6\n[contact]\nself = true\n[time]\nframes = 12\n";
    std::vector<TriangleMesh> meshes;
    for (int i = 0; i < 3; ++i) {
      text += "[[body]]\nmesh = 'box'\nnodes = 150\nposition = [0, 0, " + std::to_string((1 + gap) * i) + "]\n" +
              (i == 0 ? "fixed = [[-1, -1, -1, 2, 2, 0.3]]\n" : "");
      meshes.push_back(box({1, 1, 1}, 0.34));
    }
    const Scene scene = parse_scene(text, "s.toml");
    const PlacedModels models = place_models(scene, meshes);
    CHECK(models.touching.size() == (gap > 0 ? 0 : 2));
    Simulation run(scene, models);
    for (int frame = 0; frame < scene.frames; ++frame) {
      run.advance_frame();
      CHECK(count_crossings(run.surface()) == 0);
    }
    double sunk = 0;
    for (std::size_t i = 0; i < run.state().body_index.size(); ++i)
      if (run.state().body_index[i] == 2) sunk = std::max(sunk, -run.state().motion.displacement[i].z());
    CHECK(sunk < 0.15);
  }
}
