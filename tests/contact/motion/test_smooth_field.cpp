#include "contact/motion/smooth_field.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

struct Cloud {
  std::vector<Vec3> at, motion;
  std::vector<std::uint32_t> all;
  explicit Cloud(Random& random, double noise) {
    for (int i = 0; i < 400; ++i) {
      const Vec3 p(random.uniform(), random.uniform(), random.uniform());
      at.push_back(p);
      motion.push_back(Vec3(std::sin(3 * p.y()), p.x() * p.z(), std::cos(2 * p.x())) + noise * random.direction());
    }
    all.resize(at.size());
    std::iota(all.begin(), all.end(), 0u);
  }
};

}  // namespace

TEST_CASE("a smooth field of equal motions is that motion, without slope") {
  Random random(1);
  Cloud cloud(random, 0);
  const Vec3 same(0.3, -1, 2);
  for (Vec3& m : cloud.motion) m = same;
  const SmoothField field(cloud.at, cloud.motion, cloud.all, 0.2);
  for (const Vec3& p : cloud.at) CHECK((field(p) - same).norm() < 1e-14);
  CHECK(field.deviation(0.2) < 1e-12);
  CHECK(field.deviation(0.3) > 1e300);  // longer than a cell
}

TEST_CASE("a smooth field changes between points no faster than its slope, and bends triangles no more than it says") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Cloud cloud(random, random.uniform(0, 1));
    const SmoothField field(cloud.at, cloud.motion, cloud.all, random.uniform(0.1, 0.4));
    double steepest = 0;
    for (int i = 0; i < 300; ++i) {
      const auto any = [&] { return cloud.at[random.below(static_cast<std::uint32_t>(cloud.at.size()))]; };
      const Vec3 p = any(), q = any();
      if (p == q) continue;
      steepest = std::max(steepest, (field(p) - field(q)).norm() / (p - q).norm());
      // A small triangle inside the cloud's box.
      const double size = random.uniform(0, 0.1);
      const auto near = [&] { return Vec3((p + size * random.direction()).cwiseMax(0.05).cwiseMin(0.95)); };
      const Vec3 a = near(), b = near(), c = near();
      const double u = random.uniform(), v = random.uniform(0, 1 - u), w = 1 - u - v;
      const double edge = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
      const double off = (field(u * a + v * b + w * c) - (u * field(a) + v * field(b) + w * field(c))).norm();
      CHECK(off <= field.deviation(edge) * (1 + 1e-9) + 1e-13);
    }
    CHECK(steepest <= field.slope() * (1 + 1e-9));
    CHECK(steepest > 0.05 * field.slope());  // the bound is of the right size
  }
}
