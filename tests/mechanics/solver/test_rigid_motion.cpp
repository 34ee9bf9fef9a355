// Pieces that move as a whole: found out of their nodes' ways, and kept by time steps however stiff
// they are.
#include "mechanics/solver/rigid_motion.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"

using namespace geo;

namespace {

Mat3 turned(const Vec3& by) {
  return by.norm() > 0 ? Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix() : Mat3(Mat3::Identity());
}

struct Nodes {
  std::vector<Vec3> place, way;
  std::vector<double> mass;
  std::vector<std::uint32_t> piece;
  std::vector<RigidMotion> motions(const std::vector<Freedom>& freedom) const {
    return rigid_motions(
        piece, freedom, mass, [&](std::size_t i) { return place[i]; }, [&](std::size_t i) { return way[i]; });
  }
};

Material stiff(double young, double poisson) {
  Material m;
  m.young = young, m.poisson = poisson, m.density = 1000, m.damping = 0;
  return m;
}

// A bar from the left end to the right one: its angle to the ground.
double slope(const Body& body, const State& state) {
  Vec3 way = Vec3::Zero();
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    way += (body.nodes.position[i].x() > 1 ? 1 : -1) * (body.nodes.position[i] + state.displacement[i]);
  return std::atan2(way.z(), way.x());
}

}  // namespace

TEST_CASE("rigid motions are found, whatever else the nodes do, and by any number of threads", "[mechanics]") {
  const auto [first_seed, count] = seeds(300);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    CAPTURE(seed);
    Random random(seed);
    const std::size_t pieces = 1 + random.below(5), n = pieces * (4 + random.below(k % 10 == 0 ? 3000 : 60));
    const double size = std::pow(10.0, random.uniform(-3, 3));
    const Vec3 far = 100 * size * random.direction();
    struct Truth {
      Vec3 turn, way;
    };
    std::vector<Truth> truth(pieces);
    for (auto& t : truth) t = {random.uniform(0, 3) * random.direction(), size * random.direction()};
    Nodes nodes;
    for (std::size_t i = 0; i < n; ++i) {
      const auto p =
          static_cast<std::uint32_t>(i < 4 * pieces ? i % pieces : random.below(static_cast<std::uint32_t>(pieces)));
      nodes.piece.push_back(p), nodes.mass.push_back(random.uniform(0.1, 2)),
          nodes.place.push_back(far + size * random.direction());
      nodes.way.push_back(turned(truth[p].turn) * (nodes.place[i] - far) + far + truth[p].way - nodes.place[i]);
    }
    const std::vector<Freedom> all(pieces, Freedom::way_and_turn);
    const auto found = nodes.motions(all);
    for (std::size_t i = 0; i < n; ++i)
      CHECK((found[nodes.piece[i]].displacement(nodes.place[i]) - nodes.way[i]).norm() < 1e-9 * size);

    // Of any ways: what is left beside straight() has neither momentum. bend() is what a turn of
    // that axis and angle adds.
    for (Vec3& way : nodes.way) way = 0.3 * size * random.direction();
    const auto mean = nodes.motions(all);
    std::vector<Vec3> linear(pieces, Vec3::Zero()), angular = linear;
    for (std::size_t i = 0; i < n; ++i) {
      const RigidMotion& m = mean[nodes.piece[i]];
      const Vec3 left = nodes.mass[i] * (nodes.way[i] - m.straight(nodes.place[i]));
      linear[nodes.piece[i]] += left, angular[nodes.piece[i]] += (nodes.place[i] - m.middle).cross(left);
      const double share = random.uniform(0, 1);
      const Vec3 arm = nodes.place[i] - m.middle, rest = nodes.way[i] - m.straight(nodes.place[i]);
      const Vec3 round = share * m.way + turned(share * m.turning) * (arm + share * rest) - arm;
      CHECK((share * nodes.way[i] + m.bend(nodes.place[i], nodes.way[i], share) - round).norm() < 1e-12 * size);
    }
    for (std::size_t p = 0; p < pieces; ++p) {
      CHECK(linear[p].norm() < 1e-9 * size * double(n));
      CHECK(angular[p].norm() < 1e-9 * size * size * double(n));
    }

    // A piece without freedom has no motion, one that only goes does not turn; others are as they
    // were, with one thread, too.
    std::vector<Freedom> some(all);
    some[0] = k % 2 ? Freedom::none : Freedom::way;
    set_threads(1);
    const auto other = nodes.motions(some);
    set_threads(0);
    CHECK(other[0].way == (k % 2 ? Vec3(Vec3::Zero()) : mean[0].way));
    CHECK((other[0].turning == Vec3(Vec3::Zero()) && other[0].turn == Mat3(Mat3::Identity())));
    for (std::size_t p = 1; p < pieces; ++p)
      CHECK((other[p].way == mean[p].way && other[p].turning == mean[p].turning && other[p].turn == mean[p].turn));
  }
}

TEST_CASE("nodes on a line or in one place turn about nothing", "[mechanics]") {
  Nodes line{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {5, 5, 5}},
             {{0, 0, 0}, {0, 1, 0}, {0, 3, 0}, {1, 2, 3}},
             {1, 1, 1, 1},
             {0, 0, 0, 1}};
  const auto motion = line.motions({Freedom::way_and_turn, Freedom::way_and_turn});
  CHECK((motion[0].turning - Vec3(0, 0, 1)).norm() < 1e-12);
  CHECK(motion[0].turn == Mat3(Mat3::Identity()));
  CHECK(motion[1].way == Vec3(1, 2, 3));
  CHECK((motion[1].turning.isZero(0) && motion[1].reach == 0));
}

TEST_CASE("a crumb of two nodes, which the nodal discretisation holds by its penalty alone, gains no energy by turning",
          "[mechanics]") {
  NodeSet nodes;
  VisibilityGraph graph;
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0.1, 0)})
    nodes.position.push_back(x), nodes.radius.push_back(1.9), nodes.spacing.push_back(1), nodes.volume.push_back(1);
  graph.storage().resize(2);
  graph.storage().add(nodes, 1u, 0u);
  build_neighborhoods(nodes, graph, TriangleBvh());
  for (const double young : {1e4, 1e7, 1e10}) {
    const Solid solid(nodes, graph, stiff(young, 0.3));
    REQUIRE(solid.moment_quality(NodeId(0u)) == MomentQuality::singular);
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
    const Solid solid(body, stiff(young, 0.3));
    State state{std::vector<Vec3>(n), std::vector<Vec3>(n, Vec3::Zero())};
    for (std::size_t i = 0; i < n; ++i)
      state.displacement[i] = tilted * body.nodes.position[i] + Vec3(0, 0, 0.3) - body.nodes.position[i];
    Environment env;
    env.ground = true;
    std::vector<double> slopes;
    for (int k = 0; k < 75; ++k) solid.step_implicit(state, 0.02, env, accuracy), slopes.push_back(slope(body, state));
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
