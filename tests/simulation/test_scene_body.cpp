// The body of a scene: which body each node belongs to, and its material.
#include "simulation/scene_body.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

// One to three boxes and balls in a row, a model unit apart, with two materials at most.
struct Row {
  Scene scene;
  std::vector<TriangleMesh> meshes;
  explicit Row(Random& random) {
    scene.seed = random.bits();
    scene.material.young = 1e5;
    const std::uint32_t bodies = 1 + random.below(3);
    for (std::uint32_t b = 0; b < bodies; ++b) {
      SceneBody body;
      body.name = std::string(1, static_cast<char>('a' + b));
      body.spacing_percent = random.uniform(8, 12);
      if (random.below(2) == 0) body.sampling.spacing = random.uniform(0.15, 0.2);
      if (random.below(2) == 0) {
        body.material = scene.material;
        body.material->density = 2000;
      }
      meshes.push_back(random.below(2) == 0 ? make_sphere(4) : make_block({1, 0.8, 0.6}, 0.3));
      body.place.position = {3.0 * b, 0, 0};
      scene.bodies.push_back(body);
    }
  }
};

}  // namespace

TEST_CASE("each node of a scene's body is inside the body that it belongs to, which is sampled as if alone") {
  const auto [first, count] = seeds(10);
  std::size_t several = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Row row(random);
    const PlacedModels models = place_models(row.scene, row.meshes);
    std::vector<std::uint32_t> body_index;
    const Body body = build_scene_body(row.scene, models, body_index);
    REQUIRE(body_index.size() == body.nodes.size());
    CHECK(body.k == row.scene.k);
    std::vector<Box3> boxes;
    for (const TriangleMesh& m : models.bodies) boxes.push_back(bounding_box(m));
    std::vector<double> volume(boxes.size(), 0);
    std::vector<std::vector<Vec3>> nodes(boxes.size());
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      REQUIRE(body_index[i] < boxes.size());
      const Vec3& x = body.nodes.position[i];
      CHECK(boxes[body_index[i]].meets({x, x}));
      volume[body_index[i]] += body.nodes.volume[i];
      if (i < body.original_nodes) nodes[body_index[i]].push_back(x);
    }
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      CHECK(volume[b] == Approx(signed_volume(models.bodies[b])).epsilon(1e-9));
      SampleOptions sampling = row.scene.bodies[b].sampling;
      sampling.seed = row.scene.seed;
      if (sampling.spacing == 0) sampling.spacing = row.scene.bodies[b].spacing_percent / 100 * boxes[b].diagonal();
      CHECK(nodes[b] == sample_nodes(models.bodies[b], sampling).position);
    }
    several += boxes.size() > 1;
    CHECK(check_body(body).first_problem == "");
  }
  CHECK(several > 0);
}

TEST_CASE("a node has the material of its body, or the scene's, and equal ones stand once in the table") {
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Row row(random);
    std::vector<std::uint32_t> body_index;
    for (int i = 0; i < 40; ++i)
      body_index.push_back(random.below(static_cast<std::uint32_t>(row.scene.bodies.size())));
    const Materials materials = materials_of(row.scene, body_index);
    REQUIRE(materials.fits(body_index.size()));
    for (std::size_t i = 0; i < body_index.size(); ++i) {
      const SceneBody& own = row.scene.bodies[body_index[i]];
      CHECK(materials.of(i) == own.material.value_or(row.scene.material));
    }
    for (std::size_t a = 0; a < materials.count(); ++a)
      for (std::size_t b = 0; b < a; ++b) CHECK_FALSE(materials[a] == materials[b]);
  }
}
