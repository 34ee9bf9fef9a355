// The guard's tests, each on an edit that has one fault.
#include <catch2/catch.hpp>
#include <cmath>

#include "crack/edit_quality.h"
#include "crack/guard.h"
#include "crack/local_edit.h"
#include "crack/noise.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

// Replaces all faces at v by those with v at p.
Fault fault_of_move(const Complex& k, VertexId v, const Vec3& p) {
  auto local = crack::relocate(k, v, p);
  return find_fault(k, local.edit, {.families = local.families});
}

}  // namespace

TEST_CASE("the guard accepts a small move and names the fault of a large one") {
  const Complex k = Complex::from_skin(make_block({2, 2, 2}, 1));
  VertexId middle;  // of the top face
  for (std::uint32_t v = 0; v < k.vertex_count(); ++v)
    if (k.point(VertexId(v)) == Vec3(1, 1, 2)) middle = VertexId(v);
  REQUIRE(middle.valid());
  CHECK_FALSE(fault_of_move(k, middle, {1.1, 0.9, 2}));
  CHECK(fault_of_move(k, middle, {2.5, 1, 2}).what == "rounding would turn a face over");
  CHECK(fault_of_move(k, middle, {2, 2, 2}));
  CHECK(fault_of_move(k, middle, {1, 1, -0.5}));
}

TEST_CASE("an edit keeps the complex valid, and undo() restores it") {
  Complex k = Complex::from_skin(make_block({2, 2, 2}, 1));
  const TriangleMesh before = k.two_sided();
  const auto edge = k.face(FaceId(std::uint32_t(0))).v;
  auto local = crack::divide(k, edge[0], edge[1], 0.5 * (k.point(edge[0]) + k.point(edge[1])));
  REQUIRE(crack::is_sound(k, local));
  DeltaSum sum;
  REQUIRE(crack::try_commit(k, local, sum));
  CHECK(sum.sum().new_faces.size() == 4);
  CHECK(sum.sum().removed_faces.size() == 2);
  CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
  CHECK(signed_volume(k.two_sided()) == Approx(8));
  k.undo();
  CHECK(k.two_sided().triangles == before.triangles);
  CHECK(k.two_sided().vertices == before.vertices);
}

TEST_CASE("the cotangent of the smallest angle measures quality") {
  const std::array<Vec3, 3> right{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  CHECK(crack::smallest_angle_cotangent(right) == Approx(1));
  CHECK(smallest_angle(right) == Approx(45));
  const std::array<Vec3, 3> equilateral{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, std::sqrt(0.75), 0)};
  CHECK(smallest_angle(equilateral) == Approx(60));
}

TEST_CASE("gradient noise is zero at lattice points, bounded and reproducible") {
  for (int i = 0; i < 50; ++i) {
    CHECK(gradient_noise({i * 1.0, -i * 2.0, 3}, 7) == 0);
    const Vec3 p(0.37 * i, 0.61 * i - 5, 0.83 * i);
    CHECK(std::abs(gradient_noise(p, 7)) < 1.2);
    CHECK(gradient_noise(p, 7) == gradient_noise(p, 7));
  }
  CHECK(gradient_noise({0.4, 0.3, 0.2}, 7) != gradient_noise({0.4, 0.3, 0.2}, 8));
}
