// Rigid and affine fits recover motions exactly, and fall back where there is none.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "geometry/affine_fit.h"
#include "geometry/nearest_rotation.h"
#include "kerf/parallel.h"

using namespace geo;

namespace {

struct Points {
  std::vector<std::uint32_t> indices;
  std::vector<Vec3> from, to;
};

// Points of which every third is left out of the fit.
template <class Map>
Points points(Random& random, std::uint32_t count, const Map& map) {
  Points p;
  for (std::uint32_t i = 0; i < count; ++i) {
    p.from.push_back(Vec3(1, 2, 3) + random.uniform() * random.direction());
    p.to.push_back(i % 3 == 2 ? Vec3(random.direction()) : Vec3(map(p.from.back())));
    if (i % 3 != 2) p.indices.push_back(i);
  }
  return p;
}

Mat3 random_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(-3, 3), random.direction()).toRotationMatrix();
}

double largest_error(const Points& p, const std::vector<Vec3>& at) {
  double error = 0;
  for (const auto i : p.indices) error = std::max(error, (at[i] - p.to[i]).norm());
  return error;
}

}  // namespace

TEST_CASE("fits recover rigid motions, and leave other points alone", "[affine-fit]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Mat3 rotation = random_rotation(random);
    const Vec3 shift = 3 * random.direction();
    const Points p = points(random, 10 + random.below(3000), [&](const Vec3& x) { return Vec3(rotation * x + shift); });
    for (const auto& fit : {apply_rigid_fit, apply_affine_fit}) {
      std::vector<Vec3> at(p.from.size(), Vec3(9, 9, 9));
      fit(p.indices, p.from, p.to, at);
      REQUIRE(largest_error(p, at) < 1e-10);
      for (std::size_t i = 2; i < at.size(); i += 3) REQUIRE(at[i] == Vec3(9, 9, 9));
    }
  }
}

TEST_CASE("the affine fit recovers affine motions, the rigid fit their rotation", "[affine-fit]") {
  Random random(4);
  const Mat3 rotation = random_rotation(random), stretch = Vec3(1.2, 0.9, 1.1).asDiagonal();
  const Points p = points(random, 300, [&](const Vec3& x) { return Vec3(rotation * (stretch * x)); });
  std::vector<Vec3> affine(p.from.size()), rigid(p.from.size());
  apply_affine_fit(p.indices, p.from, p.to, affine);
  apply_rigid_fit(p.indices, p.from, p.to, rigid);
  CHECK(largest_error(p, affine) < 1e-10);
  CHECK(largest_error(p, rigid) > 0.01);
  const auto distance = [&](const std::vector<Vec3>& at, std::size_t i, std::size_t j) {
    return (at[i] - at[j]).norm();
  };
  for (std::size_t i = 0; i + 1 < p.indices.size(); ++i)
    REQUIRE(distance(rigid, p.indices[i], p.indices[i + 1]) ==
            Approx(distance(p.from, p.indices[i], p.indices[i + 1])).margin(1e-12));
}

TEST_CASE("the affine fit is rigid where the points are coplanar, flattened or mirrored", "[affine-fit]") {
  Random random(5);
  const Mat3 rotation = random_rotation(random);
  Points p = points(random, 60, [&](const Vec3& x) { return Vec3(rotation * Vec3(x.x(), x.y(), 0)); });
  SECTION("coplanar") {
    for (Vec3& x : p.from) x.z() = 0;
  }
  SECTION("flattened") {}
  SECTION("mirrored") {
    for (std::size_t i = 0; i < p.to.size(); ++i) p.to[i] = -p.from[i];
  }
  std::vector<Vec3> affine(p.from.size(), Vec3::Zero()), rigid = affine;
  apply_affine_fit(p.indices, p.from, p.to, affine);
  apply_rigid_fit(p.indices, p.from, p.to, rigid);
  CHECK(affine == rigid);
}

TEST_CASE("fits are the same for any number of threads", "[affine-fit]") {
  Random random(6);
  const Points p = points(random, 20000, [&](const Vec3& x) { return Vec3(x + 0.1 * random.direction()); });
  std::vector<Vec3> one(p.from.size(), Vec3::Zero()), many = one;
  set_threads(1);
  apply_affine_fit(p.indices, p.from, p.to, one);
  set_threads(3);
  apply_affine_fit(p.indices, p.from, p.to, many);
  set_threads(0);
  CHECK(one == many);
}

TEST_CASE("no rotation is nearer to a matrix than the nearest one", "[affine-fit]") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Mat3 a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.uniform(-1, 1);
    const NearestRotation nearest = nearest_rotation(a);
    const Mat3& rotation = nearest.rotation;
    const Vec3& singular = nearest.singular_values;
    REQUIRE((nearest.u * nearest.sign * nearest.v.transpose() - rotation).norm() < 1e-14);
    REQUIRE((rotation.transpose() * rotation - Mat3::Identity()).norm() < 1e-12);
    REQUIRE(rotation.determinant() == Approx(1).margin(1e-12));
    REQUIRE((singular[0] >= singular[1] && singular[1] >= singular[2] && singular[2] >= 0));
    REQUIRE(singular.prod() == Approx(std::abs(a.determinant())).margin(1e-12));
    for (int k = 0; k < 50; ++k) REQUIRE((a - rotation).norm() <= (a - random_rotation(random)).norm() + 1e-12);
    const Mat3 turn = random_rotation(random);
    REQUIRE((nearest_rotation(turn).rotation - turn).norm() < 1e-12);
  }
}
