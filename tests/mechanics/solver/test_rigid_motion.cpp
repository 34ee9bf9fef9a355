// Rigid motions: recovered from nodal displacements, and preserved by time steps however stiff the
// material is.
#include "mechanics/solver/rigid_motion.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/response/obstacle_penalty.h"
#include "contact/surface/surface_targets.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

Mat3 turned(const Vec3& by) {
  return by.norm() > 0 ? Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix() : Mat3(Mat3::Identity());
}

struct Nodes {
  std::vector<Vec3> position, displacement;
  std::vector<double> mass;
  std::vector<std::uint32_t> set;
  std::vector<RigidMotion> motions(const std::vector<Freedom>& freedom) const {
    return rigid_motions(
        set, freedom, mass, [&](std::size_t i) { return position[i]; }, [&](std::size_t i) { return displacement[i]; });
  }
};

Material stiff(double young, double poisson) {
  Material m;
  m.young = young;
  m.poisson = poisson;
  m.density = 1000;
  m.damping = 0;
  return m;
}

// The angle of a bar to the ground.
double slope(const Body& body, const State& state) {
  Vec3 axis = Vec3::Zero();
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    axis += (body.nodes.position[i].x() > 1 ? 1 : -1) * (body.nodes.position[i] + state.displacement[i]);
  return std::atan2(axis.z(), axis.x());
}

}  // namespace

TEST_CASE("rigid motions are recovered from nodal displacements, the same by any number of threads", "[mechanics]") {
  const auto [first_seed, count] = seeds(300);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    CAPTURE(seed);
    Random random(seed);
    const std::size_t sets = 1 + random.below(5), n = sets * (4 + random.below(k % 10 == 0 ? 3000 : 60));
    const double size = std::pow(10.0, random.uniform(-3, 3));
    const Vec3 far = 100 * size * random.direction();
    struct Truth {
      Vec3 angle, translation;
    };
    std::vector<Truth> truth(sets);
    for (auto& t : truth) t = {random.uniform(0, 3) * random.direction(), size * random.direction()};
    Nodes nodes;
    for (std::size_t i = 0; i < n; ++i) {
      const auto p =
          static_cast<std::uint32_t>(i < 4 * sets ? i % sets : random.below(static_cast<std::uint32_t>(sets)));
      nodes.set.push_back(p);
      nodes.mass.push_back(random.uniform(0.1, 2));
      nodes.position.push_back(far + size * random.direction());
      nodes.displacement.push_back(turned(truth[p].angle) * (nodes.position[i] - far) + far + truth[p].translation -
                                   nodes.position[i]);
    }
    const std::vector<Freedom> all(sets, Freedom::rigid);
    const auto found = nodes.motions(all);
    for (std::size_t i = 0; i < n; ++i)
      CHECK((found[nodes.set[i]].displacement(nodes.position[i]) - nodes.displacement[i]).norm() < 1e-9 * size);

    // Random displacements less linearised() have neither momentum. arc_correction() is what a
    // rotation by this axis and angle adds.
    for (Vec3& d : nodes.displacement) d = 0.3 * size * random.direction();
    const auto mean = nodes.motions(all);
    std::vector<Vec3> linear(sets, Vec3::Zero()), angular = linear;
    for (std::size_t i = 0; i < n; ++i) {
      const RigidMotion& m = mean[nodes.set[i]];
      const Vec3 residual = nodes.mass[i] * (nodes.displacement[i] - m.linearised(nodes.position[i]));
      linear[nodes.set[i]] += residual;
      angular[nodes.set[i]] += (nodes.position[i] - m.centre).cross(residual);
      const double share = random.uniform(0, 1);
      const Vec3 arm = nodes.position[i] - m.centre, rest = nodes.displacement[i] - m.linearised(nodes.position[i]);
      const Vec3 arc = share * m.translation + turned(share * m.angle) * (arm + share * rest) - arm;
      CHECK((share * nodes.displacement[i] + m.arc_correction(nodes.position[i], nodes.displacement[i], share) - arc)
                .norm() < 1e-12 * size);
    }
    for (std::size_t p = 0; p < sets; ++p) {
      CHECK(linear[p].norm() < 1e-9 * size * double(n));
      CHECK(angular[p].norm() < 1e-9 * size * size * double(n));
    }

    // A set without freedom has no motion, one that is only translated no rotation; the others have
    // the same motion as before, also with one thread.
    std::vector<Freedom> some(all);
    some[0] = k % 2 ? Freedom::none : Freedom::translation;
    set_threads(1);
    const auto other = nodes.motions(some);
    set_threads(0);
    CHECK(other[0].translation == (k % 2 ? Vec3(Vec3::Zero()) : mean[0].translation));
    CHECK((other[0].angle == Vec3(Vec3::Zero()) && other[0].rotation == Mat3(Mat3::Identity())));
    for (std::size_t p = 1; p < sets; ++p)
      CHECK((other[p].translation == mean[p].translation && other[p].angle == mean[p].angle &&
             other[p].rotation == mean[p].rotation));
  }
}

TEST_CASE("nodes on a line have no rotation about it, coincident nodes none at all", "[mechanics]") {
  Nodes line{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {5, 5, 5}},
             {{0, 0, 0}, {0, 1, 0}, {0, 3, 0}, {1, 2, 3}},
             {1, 1, 1, 1},
             {0, 0, 0, 1}};
  const auto motion = line.motions({Freedom::rigid, Freedom::rigid});
  CHECK((motion[0].angle - Vec3(0, 0, 1)).norm() < 1e-12);
  CHECK(motion[0].rotation == Mat3(Mat3::Identity()));
  CHECK(motion[1].translation == Vec3(1, 2, 3));
  CHECK((motion[1].angle.isZero(0) && motion[1].radius == 0));
}

TEST_CASE("a crumb of two nodes, which the nodal discretisation holds by its penalty alone, gains no energy by turning",
          "[mechanics]") {
  NodeSet nodes;
  VisibilityGraph graph;
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0.1, 0)}) {
    nodes.position.push_back(x);
    nodes.radius.push_back(1.9);
    nodes.spacing.push_back(1);
    nodes.volume.push_back(1);
  }
  GraphStorage::of(graph).resize(2);
  GraphStorage::of(graph).add(nodes, 1u, 0u);
  build_neighborhoods(nodes, graph, TriangleBvh());
  for (const double young : {1e4, 1e7, 1e10}) {
    Solid solid(nodes, graph, stiff(young, 0.3));
    REQUIRE(SolidDiscretisation::of(solid).mls.quality(0) == MomentQuality::singular);
    State state{std::vector<Vec3>(2, Vec3::Zero()), {Vec3::Zero(), Vec3(-0.05, 0.5, 0)}};
    Environment env;
    env.gravity.setZero();
    const Vec3 momentum = solid.momentum(state);
    double before = solid.energy(state.displacement) + solid.kinetic_energy(state);
    for (int k = 0; k < 20; ++k) {
      solid.step_implicit(state, 0.02, env, 1e-3);
      const double now = solid.energy(state.displacement) + solid.kinetic_energy(state);
      INFO("Young's modulus " << young << ", step " << k << ": " << before << " -> " << now);
      CHECK(now < before * (1 + 1e-3));
      before = now;
    }
    CHECK((solid.momentum(state) - momentum).norm() < 1e-9 * momentum.norm());
  }
}

TEST_CASE("a stiff bar topples as a softer one does, and lies flat", "[mechanics]") {
  const Body body = block_body({2, 0.4, 0.4}, 0.1);
  const std::size_t n = body.nodes.size();
  const Mat3 tilted = turned({0, -0.6, 0});
  const auto fall = [&](double young, double accuracy) {
    Solid solid(body, stiff(young, 0.3));
    State state{std::vector<Vec3>(n), std::vector<Vec3>(n, Vec3::Zero())};
    for (std::size_t i = 0; i < n; ++i)
      state.displacement[i] = tilted * body.nodes.position[i] + Vec3(0, 0, 0.3) - body.nodes.position[i];
    SurfaceWeights weights;
    weights.rebuild(body, solid);
    const Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    ObstaclePenalty ground(std::make_shared<RigidShape>(RigidShape::half_space(Vec3::UnitZ())), {1e6, 0.5}, place,
                           place);
    Environment env;
    env.contact = {&ground};
    std::vector<double> slopes;
    for (int k = 0; k < 75; ++k) {
      ground.find_contacts(weights, surface_targets(weights, state.displacement), 1, 4e-5);
      solid.step_implicit(state, 0.02, env, accuracy);
      slopes.push_back(slope(body, state));
    }
    return slopes;
  };
  const auto soft = fall(1e7, 1e-3);
  REQUIRE((soft[0] > 0.58 && std::abs(soft.back()) < 0.01));
  for (const double young : {1e9, 5e10})
    for (const double accuracy : {1e-3, 0.01}) {
      const auto slopes = fall(young, accuracy);
      INFO("Young's modulus " << young << ", accuracy " << accuracy);
      double most = 0;
      for (std::size_t k = 0; k < 24; ++k) most = std::max(most, std::abs(slopes[k] - soft[k]));
      CHECK(most < 0.06);  // up to where it strikes the ground
      CHECK(std::abs(slopes.back()) < 0.01);
    }
}
