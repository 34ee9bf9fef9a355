#include "contact/response/contact_constraints.h"

#include <catch2/catch.hpp>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "contact/response/impulses.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

struct Block {
  Body body;
  Solid solid;
  SurfaceWeights weights;
  Block() : body(sampled()), solid(body.nodes, body.graph, Material()) { weights.rebuild(body, solid); }
  static Body sampled() {
    SampleOptions sampling;
    sampling.spacing = 0.35;
    const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
    return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  }
};

SurfacePoint random_point(Random& random, std::uint32_t vertices) {
  SurfacePoint p{{}, {}, 3};
  const double u = random.uniform(), v = random.uniform(0, 1 - u);
  for (int c = 0; c < 3; ++c) {
    p.vertex[c] = random.below(vertices);
    p.weight[c] = c == 0 ? u : c == 1 ? v : 1 - u - v;
  }
  return p;
}

}  // namespace

TEST_CASE("a relative stencil is the difference of the interpolated displacements of its points") {
  const Block block;
  const auto n = static_cast<std::uint32_t>(block.weights.size());
  Random random(1);
  std::vector<double> inverse_mass;
  std::vector<Vec3> u;
  for (std::size_t i = 0; i < block.solid.size(); ++i) {
    inverse_mass.push_back(i % 5 == 0 ? 0 : 1 / block.solid.mass(NodeId(i)));
    u.push_back(random.direction());
  }
  const auto alone = CoincidentVertices::all_distinct(n);
  RelativeStencilBuilder builder(block.weights, alone, inverse_mass);
  const auto at = [&](const SurfacePoint& p) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < p.size; ++k) sum += p.weight[k] * block.weights.interpolate(p.vertex[k], u);
    return sum;
  };
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint a = random_point(random, n), b = random_point(random, n);
    const RelativeStencil stencil = builder.make(a, b);
    CHECK((weighted_sum(stencil.entries, u) - (at(a) - at(b))).norm() < 1e-12);
    double sum = 0, inverse = 0;
    std::map<std::uint32_t, int> times;
    for (const auto& e : stencil.entries) {
      sum += e.weight;
      inverse += e.weight * e.weight * inverse_mass[e.node];
      ++times[e.node];
    }
    CHECK(std::abs(sum) < 1e-12);  // a common translation is no relative motion
    CHECK(stencil.inverse_mass == Approx(inverse).epsilon(1e-12));
    for (const auto& [node, count] : times) CHECK(count == 1);
    const RelativeStencil swapped = builder.make(b, a);
    CHECK(swapped.inverse_mass_a == Approx(stencil.inverse_mass_b).epsilon(1e-12));
    const RelativeStencil none = builder.make(a, a);
    CHECK(none.inverse_mass == Approx(0).margin(1e-20));
    CHECK(none.inverse_mass_a == Approx(none.inverse_mass_b));
  }
}

TEST_CASE("of the constraints between two nodes' neighbourhoods the deepest are kept, in their order") {
  const Block block;
  const auto n = static_cast<std::uint32_t>(block.weights.size());
  Random random(2);
  std::vector<ContactConstraint> constraints;
  for (int i = 0; i < 3000; ++i) {
    ContactConstraint c{{{random.below(n)}, {1}, 1}, {{random.below(n)}, {1}, 1}, Vec3::UnitX(), 0, 0};
    c.depth = random.uniform();
    constraints.push_back(c);
  }
  const auto& node = block.weights.heaviest();
  const auto nodes_of = [&](const ContactConstraint& c) {
    return std::minmax(node[c.a.vertex[0]], node[c.b.vertex[0]]);
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>> depths;
  for (const auto& c : constraints) depths[nodes_of(c)].push_back(c.depth);
  std::vector<double> expected, found;
  std::size_t dropped = 0;
  for (const auto& c : constraints) {
    auto& all = depths[nodes_of(c)];
    const auto deeper = std::count_if(all.begin(), all.end(), [&](double d) { return d > c.depth; });
    if (deeper < 2)
      expected.push_back(c.depth);
    else
      ++dropped;
  }
  for (const auto& c : deepest_constraints(constraints, block.weights, 2)) found.push_back(c.depth);
  REQUIRE(dropped > 0);
  CHECK(found == expected);
}

TEST_CASE("points that neighbouring triangles share are constrained once, whatever the order of candidates") {
  // A vertex above the common edge of two triangles: both are candidates with the same closest
  // points.
  const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}, {4, 5, 6}};
  const std::vector<std::uint32_t> representative{0, 1, 2, 3, 4, 5, 6};
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0.5, 0, 0.1}, {0.5, 1, 2}, {0.5, -1, 2}};
  std::vector<Vec3> to = from;
  for (std::size_t v = 4; v < 7; ++v) to[v].z() -= 0.15;
  const SurfaceMotion motion{triangles, representative, from, to, 0.01, 0.02};
  const auto candidate = [&](std::uint32_t t) {
    ContactCandidate c;
    c.a = {{4, 5, 6}, 3};
    c.b = {{triangles[t][0], triangles[t][1], triangles[t][2]}, 3};
    c.normal = Vec3::UnitZ();
    c.gap = 0.01;
    c.closest.weights_a = {1, 0, 0};
    c.closest.weights_b = {0.5, 0.5, 0};
    c.closest.difference = {0, 0, 0.1};
    return c;
  };
  const double dt = 0.5;
  for (const bool swapped : {false, true}) {
    const std::vector<ContactCandidate> candidates{candidate(swapped), candidate(!swapped)};
    const auto constraints = contact_constraints(candidates, motion, {dt});
    REQUIRE(constraints.size() == 1);
    const ContactConstraint& c = constraints[0];
    CHECK(c.a.size == 1);
    CHECK(c.b.size == 2);
    CHECK(c.depth == Approx(0.01 + 0.05).epsilon(1e-12));           // 0.1 − 0.15 is below the plane
    CHECK(c.approach == Approx((0.1 - 0.01) / dt).epsilon(1e-12));  // down to the gap
    const auto recovering = contact_constraints(candidates, motion, {dt, 0.3});
    CHECK(recovering[0].approach == Approx(-0.3 * 0.06 / dt).epsilon(1e-12));
  }
  // A motion that leaves more than the gap makes no constraint, unless it is within reach.
  std::vector<Vec3> less = from;
  for (std::size_t v = 4; v < 7; ++v) less[v].z() -= 0.08;
  const SurfaceMotion clear{triangles, representative, from, less, 0.01, 0.02};
  CHECK(contact_constraints({candidate(0)}, clear, {dt}).empty());
  CHECK(contact_constraints({candidate(0)}, clear, {dt, 0, 0.02}).size() == 1);
}

TEST_CASE("sides of a closed sheet are constrained where their targets pass each other, along their normals") {
  // Vertices 0 and 1 coincide; 0 is on a side that looks up, 1 on one that looks down: material
  // below and above.
  const std::vector<std::uint32_t> representative{0, 0, 2};
  const CoincidentVertices coincident(representative);
  const std::vector<Vec3> normals{{0, 0, 2}, {0, 0, -3}, {0, 0, 1}};
  const double dt = 0.25;
  for (const double overlap : {0.1, -0.1}) {
    const std::vector<Vec3> targets{{0, 0, overlap / 2}, {0, 0, -overlap / 2}, {5, 0, 0}};
    std::vector<ContactConstraint> constraints;
    add_sheet_constraints(coincident, targets, normals, 0.01, {dt, 0.5}, constraints);
    REQUIRE(constraints.size() == (overlap > 0));
    if (constraints.empty()) continue;
    CHECK(constraints[0].depth == Approx(0.1));
    CHECK((constraints[0].normal - Vec3(0, 0, -1)).norm() < 1e-15);  // from vertex 1 to vertex 0
    CHECK(constraints[0].approach == Approx(-0.5 * 0.1 / dt));
  }
}
