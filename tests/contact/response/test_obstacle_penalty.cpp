#include <catch2/catch.hpp>

#include "assembled_potential.h"
#include "base/random.h"
#include "cases.h"
#include "contact/response/obstacle_penalty.h"
#include "contact/response/self_contact_penalty.h"
#include "contact/surface/surface_targets.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

Eigen::Isometry3d at(const Vec3& place, const Vec3& axis = Vec3::UnitZ(), double angle = 0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = place;
  return pose;
}

struct Block {
  Body body;
  Solid solid;
  SurfaceWeights weights;
  static Body make(double spacing) {
    SampleOptions sampling;
    sampling.spacing = spacing;
    const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
    return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  }
  explicit Block(double spacing) : body(make(spacing)), solid(body, Material{}) { weights.rebuild(body, solid); }
};

}  // namespace

TEST_CASE("an obstacle's force is minus its energy's derivative, and its Hessian bounds the force's") {
  const Block block(0.3);
  Random random(3);
  const std::size_t n = block.solid.size();
  for (const bool plane : {true, false}) {
    const auto shape =
        std::make_shared<RigidShape>(plane ? RigidShape::half_space({0.1, -0.2, 1}) : RigidShape(make_pumpkin(4)));
    const Vec3 below = plane ? Vec3(0.5, 0.5, 0.1) : Vec3(0.5, 0.45, -0.5);
    ObstaclePenalty o(shape, {1e4, 0.4}, at(below), at(below + Vec3(0.01, 0, 0.004), {1, 1, 0}, 0.02));
    std::vector<Vec3> u(n, Vec3::Zero());
    o.find_contacts(block.weights, surface_targets(block.weights, u), 0.5, 1e-3);
    o.begin_substep(u, 0, 1);
    REQUIRE(o.depth(u) > 0.01);
    const std::vector<Vec3> begun = u;
    AssembledPotential assembled(o, begun);
    for (int i = 0; i < 40; ++i) {
      std::vector<Vec3> way;
      for (std::size_t k = 0; k < n; ++k) {
        u[k] = 0.01 * random.direction();
        way.push_back(random.direction());
      }
      const double h = 1e-7;
      const std::vector<Vec3> behind = assembled.force(moved(u, h, way)), before = assembled.force(moved(u, -h, way)),
                              force = assembled.force(u), turned = assembled.product(way);
      // Central differences; where a vertex passes a ridge of the field between, the derivative
      // jumps.
      const double slope = (assembled.energy(moved(u, h, way)) - assembled.energy(moved(u, -h, way))) / (2 * h);
      CHECK(-dot(force, way) == Approx(slope).epsilon(1e-4));
      if (plane)
        CHECK(dot(turned, way) >=
              -(dot(behind, way) - dot(before, way)) / (2 * h) * (1 - 1e-5));  // friction's Hessian is an upper bound
      CHECK(dot(turned, way) > 0);
    }
  }
}

TEST_CASE("an obstacle's reaction is opposite to force and torque on the body") {
  const Block block(0.3);
  const std::size_t n = block.solid.size();
  const Vec3 place(0.5, 0.45, -0.5);
  ObstaclePenalty o(std::make_shared<RigidShape>(make_pumpkin(6)), {1e4, 0.4}, at(place),
                    at(place + Vec3(0.02, 0.01, 0.01)));
  std::vector<Vec3> u(n, Vec3::Zero());
  o.find_contacts(block.weights, surface_targets(block.weights, u), 0.5, 1e-3);
  o.begin_substep(u, 0, 1);
  const std::vector<Vec3> force = AssembledPotential(o, u).force(u);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    sum += force[i];
    torque += (block.body.nodes.position[i] - (place + Vec3(0.02, 0.01, 0.01))).cross(force[i]);
  }
  const auto reaction = o.reaction(u);
  REQUIRE(sum.norm() > 1);
  CHECK((reaction.force + sum).norm() < 1e-12 * sum.norm());
  CHECK((reaction.torque + torque).norm() < 1e-9 * sum.norm());  // weights are exact for linear fields
}

TEST_CASE("contacts within their activation distance are zero: energy and force are those of all contacts") {
  const Block block(0.3);
  const auto [first, count] = seeds(40);
  const std::size_t n = block.solid.size();
  std::size_t skipped = 0, acted = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto shape = std::make_shared<RigidShape>(random.below(2) == 0 ? RigidShape::half_space({0.1, -0.2, 1})
                                                                         : RigidShape(make_pumpkin(4)));
    const Vec3 below =
        shape->extent() == 0 ? Vec3(0.5, 0.5, random.uniform(-0.2, 0.05)) : Vec3(0.5, 0.45, random.uniform(-0.8, -0.4));
    ObstaclePenalty o(shape, {1e4, 0.4}, at(below),
                      at(below + 0.05 * random.direction(), random.direction(), random.uniform(0, 0.1)));
    SelfContactPenalty touch({0.4, 0.05});
    std::vector<Vec3> u, part;
    for (std::size_t i = 0; i < n; ++i) u.push_back(0.02 * random.direction());
    o.find_contacts(block.weights, surface_targets(block.weights, u), 0.5, 1e-3);
    for (int r = 0; r < 30; ++r) {
      RelativeStencil row;
      for (int k = 0; k < 4; ++k)
        row.entries.push_back({static_cast<std::uint32_t>(4 * random.below(static_cast<std::uint32_t>(n / 4)) +
                                                          static_cast<std::uint32_t>(k)),
                               random.uniform(-1, 1)});
      touch.add(row, random.direction(), random.uniform(-0.3, 0.1), random.uniform(1, 5), u);
    }
    // In the first substep, and in a later one, before which nodes have moved.
    for (const bool later : {false, true}) {
      std::vector<Vec3> begun = u;
      for (Vec3& x : begun) x += later ? Vec3(0.05 * random.direction()) : Vec3(Vec3::Zero());
      for (Potential* p : {static_cast<Potential*>(&o), static_cast<Potential*>(&touch)}) {
        if (later) p->begin_substep(u, 0, 0.5);
        p->begin_substep(begun, later ? 0.5 : 0, later ? 1 : random.uniform(0.3, 1));
        for (const double far : {0.0, 0.003, 0.01, 0.03, 0.1, 0.3}) {
          std::vector<Vec3> x = begun;
          const Vec3 representative = far * random.direction();
          const double alike = random.uniform();
          for (Vec3& y : x) y += alike * representative + (1 - alike) * far * random.direction();
          AssembledPotential assembled(*p, begun);
          const double wanted = energy_of(*p, x);
          CHECK(assembled.energy(x) == Approx(wanted).epsilon(1e-12).margin(1e-300));
          const auto force = assembled.force(x), expected = force_of(*p, x);
          double size = 1e-12, wrong = 0;
          for (std::size_t i = 0; i < n; ++i) {
            size = std::max(size, expected[i].norm());
            wrong = std::max(wrong, (force[i] - expected[i]).norm());
          }
          CHECK(wrong < 1e-11 * size);
          acted += wanted > 0;
          for (std::size_t r = 0; r < p->size(); ++r) skipped += p->activation_distance(r) > far;
        }
        // The energy is zero when all nodes move by the activation distance in the worst direction.
        for (std::size_t r = 0; r < p->size(); ++r) {
          if (!(p->activation_distance(r) > 0)) continue;
          double most = 0;
          for (int k = 0; k < 20; ++k)
            most = std::max(most, p->energy(r, weighted_sum(p->stencil(r), begun) + 0.999 * p->activation_distance(r) *
                                                                                        weight_norm(p->stencil(r)) *
                                                                                        random.direction()));
          CHECK(most == 0);
        }
      }
    }
  }
  CHECK(acted > 0);
  CHECK(skipped > 0);
}
