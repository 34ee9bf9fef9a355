#include "contact/response/rigid_shape.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"
#include "kerf/mesh.h"

using namespace geo;

TEST_CASE("the distance field of a mesh against brute force: distance, side, derivatives") {
  const auto [first, count] = seeds(6);
  const std::vector<TriangleMesh> models{make_block({1, 0.6, 0.1}, 0.5), make_apple(4), make_letter('K', 0.3, 12),
                                         make_pumpkin(5)};
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    for (const TriangleMesh& mesh : models) {
      const RigidShape shape(mesh);
      const auto corners = corners_of(mesh);
      const TriangleBvh bvh(corners);
      const Box3 box = bvh.box().grown(0.2);
      for (int i = 0; i < 200; ++i) {
        const Vec3 x(random.uniform(box.lo.x(), box.hi.x()), random.uniform(box.lo.y(), box.hi.y()),
                     random.uniform(box.lo.z(), box.hi.z()));
        const auto field = shape.at(x);
        double least = 1e300;
        for (const auto& t : corners)
          least = std::min(least, (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm());
        CHECK(std::abs(field.distance) == Approx(least).margin(1e-14));
        CHECK((field.distance < 0) == bvh.inside(x));
        CHECK(field.normal.norm() == Approx(1));
        // Where the nearest feature does not change, half the squared distance is a quadratic
        // function.
        const Vec3 step = 1e-7 * random.direction();
        const auto other = shape.at(x + step);
        const double change = 0.5 * (std::pow(other.distance, 2) - std::pow(field.distance, 2));
        const double second =
            field.distance * field.normal.dot(step) + 0.5 * step.dot(field.half_square_hessian * step);
        if ((other.half_square_hessian - field.half_square_hessian).norm() < 1e-12)
          CHECK(change == Approx(second).margin(1e-15));
      }
    }
  }
}

TEST_CASE("a half space is near on one side only, and has the distance of its plane") {
  const RigidShape shape = RigidShape::half_space({0, 0, 4});
  const auto above = shape.at({1, 2, 0.5}), below = shape.at({1, 2, -0.25});
  CHECK(above.distance == 0.5);
  CHECK(below.distance == -0.25);
  CHECK(below.normal == Vec3(0, 0, 1));
  CHECK(below.half_square_hessian == Vec3(0, 0, 1) * Vec3(0, 0, 1).transpose());
  CHECK(shape.near({7, 7, 0.4}, 0.5));
  CHECK(shape.near({7, 7, -100}, 0.5));
  CHECK_FALSE(shape.near({7, 7, 0.6}, 0.5));
  CHECK(shape.extent() == 0);
}

TEST_CASE("the half square Hessian has the rank of the nearest feature: face 1, edge 2, vertex 3") {
  const RigidShape cube(make_block({1, 1, 1}, 1));
  const auto trace = [&](const Vec3& x) { return cube.at(x).half_square_hessian.trace(); };
  CHECK(trace({0.4, 0.3, 1.2}) == Approx(1));
  CHECK(trace({0.4, 1.2, 1.2}) == Approx(2));
  CHECK(trace({1.3, 1.2, 1.2}) == Approx(3));
  CHECK(cube.at({1.3, 1.2, 1.1}).distance == Approx(std::sqrt(0.09 + 0.04 + 0.01)));
  CHECK(cube.at({0.5, 0.5, 0.9}).distance == Approx(-0.1));
  CHECK(cube.extent() == Approx(std::sqrt(3.0)));
  CHECK_FALSE(cube.near({2.6, 0.5, 0.5}, 1.5));
  CHECK(cube.near({2.4, 0.5, 0.5}, 1.5));
}
