#include "contact/response/body_contact.h"

#include <catch2/catch.hpp>

#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

// Two unit cubes, 0.5 apart in x, as components of one body.
struct TwoBlocks {
  TriangleMesh mesh;
  Body body;
  Solid solid;
  SurfaceWeights weights;
  std::vector<std::uint32_t> body_index;
  static TriangleMesh two() {
    TriangleMesh mesh = make_block({1, 1, 1}, 0.5), other = mesh;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& p : other.vertices) mesh.vertices.push_back(p + Vec3(1.5, 0, 0));
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
    return mesh;
  }
  static Body sampled(const TriangleMesh& mesh) {
    SampleOptions sampling;
    sampling.spacing = 0.3;
    return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  }
  TwoBlocks() : mesh(two()), body(sampled(mesh)), solid(body.nodes, body.graph, Material()) {
    weights.rebuild(body, solid);
    for (const Vec3& x : body.nodes.position) body_index.push_back(x.x() > 1.25);
  }
  std::vector<Vec3> pushed(double by) const {
    std::vector<Vec3> u(solid.size(), Vec3::Zero());
    for (std::size_t i = 0; i < u.size(); ++i)
      if (body_index[i] == 1) u[i].x() = -by;
    return u;
  }
};

}  // namespace

TEST_CASE("a body that is pushed into another is as deep in it as it was pushed beyond the distance between them") {
  const TwoBlocks blocks;
  for (const double by : {0.3, 0.6}) {
    INFO(by);
    const std::vector<Vec3> u = blocks.pushed(by);
    BodyContactPenalty penalty = find_body_contacts({blocks.body, blocks.solid, blocks.weights, blocks.body_index, u},
                                                    {1e4, 0.3, 0.4, 1e-3, {}});
    if (by < 0.5) {
      CHECK(penalty.depth(u) == 0);
      continue;
    }
    REQUIRE_FALSE(penalty.empty());
    CHECK(penalty.depth(u) == Approx(by - 0.5).epsilon(1e-6));
    penalty.begin_substep(u, 0, 1);
    Vec3 on_second = Vec3::Zero(), sum = Vec3::Zero();
    for (std::size_t k = 0; k < penalty.size(); ++k) {
      const Vec3 f = penalty.derivatives(k, weighted_sum(penalty.stencil(k), u)).force;
      for (const auto& e : penalty.stencil(k)) {
        sum += e.weight * f;
        if (blocks.body_index[e.node] == 1) on_second += e.weight * f;
      }
    }
    CHECK(on_second.x() > 0);  // back out
    CHECK(std::abs(on_second.y()) < 1e-6 * on_second.x());
    CHECK(sum.norm() < 1e-9 * on_second.norm());
  }
}

TEST_CASE("one body alone has no contact with itself") {
  const TwoBlocks blocks;
  const std::vector<Vec3> u = blocks.pushed(0.6);
  const std::vector<std::uint32_t> same(u.size(), 0);
  CHECK(find_body_contacts({blocks.body, blocks.solid, blocks.weights, same, u}, {1e4, 0.3, 0.4, 1e-3, {}}).empty());
}
