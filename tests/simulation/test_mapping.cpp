// The map from the world to the material, and the fronts of blades.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "base/random.h"
#include "body/incremental_cache.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/discretisation/inverse_deformation.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

using Map = std::function<Vec3(const Vec3&)>;

// Bends the upper half of a block over.
Vec3 bent(const Vec3& x) {
  const double a = 0.6 * x.z(), r = 1 / 0.6 - x.x();
  return {1 / 0.6 - r * std::cos(a), x.y(), r * std::sin(a)};
}

// Twists a block about its axis, and bends it by waves in random directions.
Map twisted(double amplitude, Random& random) {
  const Vec3 long_wave = random.uniform(1, 6) * random.direction(), along = random.direction(),
             short_wave = random.uniform(2, 10) * random.direction(), across = random.direction();
  return [=](const Vec3& x) {
    const Vec3 axis(0.5, 0.5, 0);
    const Vec3 turned = axis + Eigen::AngleAxisd(3 * amplitude * x.z(), Vec3::UnitZ()) * (x - axis);
    return Vec3(turned +
                amplitude * (0.25 * std::sin(long_wave.dot(x)) * along + 0.05 * std::sin(short_wave.dot(x)) * across));
  };
}

// A deformed block.
struct Deformed {
  Body body = block();
  Solid solid{body.nodes, body.graph, {}};
  std::vector<Vec3> u;
  LazyNodalGradients gradient = lazy_gradients(SolidDiscretisation::of(solid), u);
  explicit Deformed(const Map& to = bent) {
    for (const Vec3& x : body.nodes.position) u.push_back(to(x) - x);
  }
  static Body block() {
    const TriangleMesh mesh = make_block({1, 1, 2}, 0.2);
    SampleOptions sampling;
    sampling.spacing = 0.2;
    sampling.levels = 1;
    return build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  }
  // Eq. 1 inside.
  Vec3 image(const Vec3& x) const {
    std::vector<std::pair<NodeId, double>> nodes;
    for (std::uint32_t n = 0; n < body.nodes.size(); ++n)
      if (const double d = (body.nodes.position[n] - x).norm(); d < body.nodes.radius[n])
        nodes.push_back({NodeId(n), d});
    return x + displacement_at(x, nodes, body.nodes, u, gradient);
  }
  Vec3 skin(SurfaceVertexId v) const {
    std::vector<std::pair<NodeId, double>> nodes;
    carrier_nodes(body, v, nodes);
    const Vec3 x = body.surface.point(body.surface.site(v));
    return x + displacement_at(x, nodes, body.nodes, u, gradient);
  }
};

}  // namespace

TEST_CASE("inside, the inverse of Eq. 1 leads back to the point") {
  const Deformed b;
  const InverseDeformation map(b.body, b.u, b.gradient, {Vec3::Constant(-9), Vec3::Constant(9)});
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(random.uniform(0.25, 0.75), random.uniform(0.25, 0.75), random.uniform(0.25, 1.75));
    const InverseDeformation::Location place = map.to_material(b.image(x));
    REQUIRE(place.in_support);
    CHECK((place.position - x).norm() < 1e-10);
  }
}

TEST_CASE("inside a block that is twisted far, the inverse loses hardly any place") {
  const auto [first, count] = seeds(12);
  int lost = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Deformed b(twisted(0.7, random));
    const InverseDeformation map(b.body, b.u, b.gradient, {Vec3::Constant(-9), Vec3::Constant(9)});
    for (int i = 0; i < 400; ++i) {
      const Vec3 x(random.uniform(0.25, 0.75), random.uniform(0.25, 0.75), random.uniform(0.25, 1.75)), y = b.image(x);
      const InverseDeformation::Location place = map.to_material(y);
      REQUIRE(place.in_support);
      lost += !((b.image(place.position) - y).norm() < 0.01);  // a twentieth of a spacing
    }
  }
  CHECK(lost <= count);  // of 400 each
}

TEST_CASE("on the skin, the inverse is linear on each deformed triangle") {
  const Deformed b;
  const InverseDeformation map(b.body, b.u, b.gradient, {Vec3::Constant(-9), Vec3::Constant(9)});
  Random random(6);
  for (std::uint32_t f = 0; f < b.body.surface.face_count(); f += 3) {
    const double s = random.uniform(0.1, 0.4), t = random.uniform(0.1, 0.4);
    Vec3 x = Vec3::Zero(), y = Vec3::Zero();
    const double weight[3] = {s, t, 1 - s - t};
    for (int k = 0; k < 3; ++k) {
      x += weight[k] * b.body.surface.point(b.body.surface.face(FaceId(f)).v[static_cast<std::size_t>(k)]);
      y += weight[k] * b.skin(b.body.surface.surface_vertex({FaceId(f), 0}, k));
    }
    CHECK((map.to_material(y).position - x).norm() < 1e-9);
  }
}

TEST_CASE("where a point was depends neither on what was asked before nor on who asks meanwhile") {
  const auto [first, count] = seeds(3);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Deformed b;
    std::vector<Vec3> points;
    for (int i = 0; i < 200; ++i) {
      const Vec3 x(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 2));
      points.push_back(
          x + b.u[b.body.cache->grid.nearest(b.body.nodes.position, x, 1, ~0u, [](std::uint32_t) { return true; })[0]]);
    }
    const Box3 all{Vec3::Constant(-9), Vec3::Constant(9)};
    const InverseDeformation map(b.body, b.u, b.gradient, all);
    std::vector<InverseDeformation::Location> found(points.size());
    set_threads(4);
    parallel_for(points.size(), 4, [&](std::size_t begin, std::size_t end) {
      InverseDeformation::VertexCache memory;
      for (std::size_t i = begin; i < end; ++i) found[i] = map.to_material(points[i], memory);
    });
    set_threads(0);
    std::size_t within = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const LazyNodalGradients fresh = lazy_gradients(SolidDiscretisation::of(b.solid), b.u);
      const InverseDeformation::Location alone = InverseDeformation(b.body, b.u, fresh, all).to_material(points[i]);
      CHECK(found[i].position == alone.position);
      CHECK(found[i].nearest == alone.nearest);
      CHECK(found[i].in_support == alone.in_support);
      within += alone.in_support;
    }
    CHECK(within > points.size() / 2);
  }
}

TEST_CASE("a blade that meets two bodies cuts both, wherever they have moved") {
  // The second block was modelled far away, and stands behind the first one.
  const Scene scene = parse_scene(
      "gravity = [0, 0, 0]\n[[body]]\nmesh = 'a'\nspacing = 0.25\n[[body]]\nmesh = 'b'\nspacing = 0.25\nposition = [0, "
      "3, 0]\nvelocity = [0, -4, 0]\n"
      "[time]\nframes = 2\nframe_rate = 4\nstep = 0.05\n[[blade]]\npoints = [[0.507, -0.4, 0], [0.503, 8.4, "
      "0]]\ndivide = 24\nlimit = 0.5\n"
      "keys = [[0.25, 0, 0, 1.3, 0, 0, 1, 0], [0.4, 0.01, 0, -0.4, 0, 0, 1, 0]]\n",
      "s.toml");
  Simulation sim(scene, place_models(scene, {make_block({1, 1, 1}, 0.25), make_block({1, 1, 1}, 0.25)}));
  REQUIRE(find_pieces(sim.body().surface).count == 2);
  FrameStats work = sim.advance_frame();
  CHECK(find_pieces(sim.body().surface).count == 2);
  work += sim.advance_frame();
  CHECK(work.refused == 0);
  CHECK(find_pieces(sim.body().surface).count == 4);
  for (const double v : find_pieces(sim.body().surface).volume) CHECK(v == Approx(0.5).epsilon(0.1));
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  CHECK(check_body(sim.body()).first_problem == "");
  CHECK(work.fronts > 2 * 6);  // two fronts in each part of a step
}

TEST_CASE("a step is cut in as many parts as its blade's limit asks for") {
  const auto run = [](const std::string& limit) {
    const Scene scene = parse_scene(
        "gravity = [0, 0, 0]\n[body]\nmesh = 'a'\nspacing = 0.25\n[time]\nframe_rate = 4\nstep = "
        "0.25\n[[blade]]\npoints = [[-0.3, 0.4, 0], [1.3, 0.41, 0]]\ndivide = 8\n"
        "keys = [[0, 0.01, 0, 1.2, 1, 0, 0, 0], [0.25, 0, 0.1, -0.3, 1, 0, 0, 20]]\nlimit = " +
            limit,
        "s.toml");
    Simulation sim(scene, make_block({1, 1, 1}, 0.25));
    const FrameStats work = sim.advance_frame();
    CHECK(work.refused == 0);
    CHECK(find_pieces(sim.body().surface).count == 2);
    CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
    return work.fronts;
  };
  const auto few = run("1.0"), many = run("0.25");
  CHECK(few >= 4);
  CHECK(many >= 3 * few);
}
