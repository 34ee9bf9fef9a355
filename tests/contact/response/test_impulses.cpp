#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/response/impulses.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

double kinetic(const Solid& solid, const std::vector<Vec3>& v) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) sum += 0.5 * solid.mass(NodeId(i)) * v[i].squaredNorm();
  return sum;
}

Vec3 momentum(const Solid& solid, const std::vector<Vec3>& v) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < v.size(); ++i) sum += solid.mass(NodeId(i)) * v[i];
  return sum;
}

// A unit block and the input of impulses on it; no surface vertices coincide.
struct StruckBlock {
  Body body;
  Solid solid;
  SurfaceWeights weights;
  std::vector<double> inverse_mass;
  CoincidentVertices alone{{}};

  StruckBlock(double edge, double spacing)
      : body(sampled(make_block({1, 1, 1}, edge), spacing)), solid(body.nodes, body.graph, Material()) {
    weights.rebuild(body, solid);
    for (std::size_t i = 0; i < solid.size(); ++i) inverse_mass.push_back(1 / solid.mass(NodeId(i)));
    alone = CoincidentVertices::all_distinct(weights.size());
  }

 private:
  static Body sampled(const TriangleMesh& mesh, double spacing) {
    SampleOptions sampling;
    sampling.spacing = spacing;
    return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling), {26, NeighborMethod::automatic});
  }
};

}  // namespace

TEST_CASE("impulses conserve momentum, stop approaching points, and do not add energy") {
  const StruckBlock block(0.25, 0.2);
  // Weights of Eq. 1 sum to one and reproduce linear motions.
  for (std::size_t v = 0; v < block.weights.size(); ++v) {
    double sum = 0;
    Vec3 x = Vec3::Zero();
    for (const auto& e : block.weights.stencil(v)) {
      sum += e.weight;
      x += e.weight * block.body.nodes.position[e.node];
    }
    CHECK(sum == Approx(1).epsilon(1e-12));
    CHECK((x - block.body.surface.point(block.body.surface.site(SurfaceVertexId(v)))).norm() < 1e-12);
  }
  const auto [first, count] = seeds(200);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto n = static_cast<std::uint32_t>(block.weights.size());
    std::vector<ContactConstraint> touching;
    for (std::uint32_t k = 0; k < 1 + random.below(30); ++k) {
      ContactConstraint t{{{}, {}, 3}, {{}, {}, 1}, random.direction(), 0};
      const double p = random.uniform(), q = random.uniform(0, 1 - p);
      for (int c = 0; c < 3; ++c) {
        t.a.vertex[c] = random.below(n);
        t.a.weight[c] = c == 0 ? p : c == 1 ? q : 1 - p - q;
      }
      t.b.vertex[0] = random.below(n);
      t.b.weight[0] = 1;
      touching.push_back(t);
    }
    std::vector<Vec3> velocity;
    for (std::size_t i = 0; i < block.solid.size(); ++i) velocity.push_back(random.uniform(0, 1) * random.direction());
    const std::vector<Vec3> before = velocity;
    ImpulseOptions options;
    options.friction = seed % 2 ? random.uniform(0, 1) : 0;
    options.sweeps = 200;
    options.tolerance = 1e-5;
    options.softness = 0;
    apply_impulses(block.weights, touching, block.alone, block.inverse_mass, options, velocity);
    CHECK((momentum(block.solid, velocity) - momentum(block.solid, before)).norm() <
          1e-12 * 1000);  // mass 1000, speed 1
    CHECK(kinetic(block.solid, velocity) <= kinetic(block.solid, before) * (1 + 1e-12));
    if (options.friction > 0) continue;
    for (const auto& t : touching) {
      Vec3 v = -block.weights.interpolate(t.b.vertex[0], velocity);
      for (int c = 0; c < 3; ++c) v += t.a.weight[c] * block.weights.interpolate(t.a.vertex[c], velocity);
      CHECK(t.normal.dot(v) > -0.02);
    }
  }
}

TEST_CASE("friction stops slow slip and slows fast slip") {
  const StruckBlock block(0.5, 0.3);
  // Two opposite corners of the block approach at speed 1 and slip at speed `slide`.
  std::uint32_t a = 0, b = 0;
  const auto at = [&](std::uint32_t v) {
    return block.body.surface.point(block.body.surface.site(SurfaceVertexId(v)));
  };
  for (std::uint32_t v = 0; v < block.weights.size(); ++v) {
    if (at(v).sum() < at(a).sum()) a = v;
    if (at(v).sum() > at(b).sum()) b = v;
  }
  for (const double slide : {0.1, 3.0}) {
    const ContactConstraint t{{{b}, {1}, 1}, {{a}, {1}, 1}, Vec3::UnitX(), 0};
    std::vector<Vec3> velocity;
    for (std::size_t i = 0; i < block.solid.size(); ++i)
      velocity.push_back(block.body.nodes.position[i].x() * Vec3(-1, slide, 0));
    ImpulseOptions options;
    options.friction = 0.5;
    options.softness = 0;
    options.sweeps = 200;
    options.tolerance = 1e-5;
    apply_impulses(block.weights, std::span(&t, 1), block.alone, block.inverse_mass, options, velocity);
    const Vec3 left = block.weights.interpolate(b, velocity) - block.weights.interpolate(a, velocity);
    CHECK(std::abs(left.x()) < 1e-6);
    CHECK(left.y() ==
          Approx(slide < 0.5 ? 0 : slide - 0.5).margin(1e-6));  // the impulse along y is half of that along x, at most
  }
}
