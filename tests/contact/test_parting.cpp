#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/parting_lanes.h"
#include "vectors.h"

using namespace geo;

TEST_CASE("directions part eight couples as far as they say, the closest places' farthest, the same for all vectors") {
  const auto [first, count] = seeds(200);
  std::size_t apart = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const bool grid = random.below(3) == 0;  // many parallel edges, and parts that touch
    std::vector<Vec3> from, to;
    std::vector<Couple> couples;
    const auto somewhere = [&](double scale) {
      return grid ? Vec3(double(random.below(3)), double(random.below(3)), double(random.below(3))) : Vec3(scale * random.uniform(0, 1) * random.direction());
    };
    for (std::uint32_t c = 0; c < 1 + random.below(Partings::width); ++c) {
      const auto simplex = [&](double x) {
        Simplex s{{}, 1 + static_cast<int>(random.below(3))};
        for (int k = 0; k < s.size; ++k) s.v[k] = static_cast<std::uint32_t>(from.size()), from.push_back(Vec3(x, 0, 0) + somewhere(1)), to.push_back(from.back() + somewhere(0.3));
        return s;
      };
      const Simplex a = simplex(0), b = simplex(grid ? random.below(4) : random.uniform(0.5, 2.5));
      couples.push_back({a, b});
    }
    Partings p;
    find_partings(couples.data(), couples.size(), from, to, true, p);
    for (std::size_t lane = 0; lane < couples.size(); ++lane) {
      const auto& [a, b] = couples[lane];
      for (int k = 0; k < Partings::count; ++k) {
        const Vec3 n(p.normal[k][0][lane], p.normal[k][1][lane], p.normal[k][2][lane]);
        CHECK((n.isZero(0) || std::abs(n.norm() - 1) < 1e-12));
        CHECK(std::abs(parted(n, a, b, from) - p.first[k][lane]) < 1e-12);
        CHECK(std::abs(parted(n, a, b, to) - p.last[k][lane]) < 1e-12);
        CHECK(p.always[k][lane] <= std::min(p.first[k][lane], p.last[k][lane]));
        CHECK(p.first[k][lane] <= std::max(0.0, p.first[Partings::closest][lane]) + 1e-9);
        CHECK(p.last[k][lane] <= std::max(0.0, p.last[Partings::closest_at_end][lane]) + 1e-9);
      }
      const auto corners = [&](const Simplex& s, Vec3 (&out)[3]) {
        for (int k = 0; k < 3; ++k) out[k] = from[s.v[std::min(k, s.size - 1)]];
      };
      Vec3 s[3], t[3], between = Vec3::Zero();
      corners(a, s), corners(b, t);
      double of_a = 0, of_b = 0;
      for (int k = 0; k < 3; ++k) {
        CHECK(p.from[k][lane] >= 0);
        CHECK(p.to[k][lane] >= 0);
        between += p.from[k][lane] * s[k] - p.to[k][lane] * t[k], of_a += p.from[k][lane], of_b += p.to[k][lane];
      }
      CHECK(std::abs(of_a - 1) + std::abs(of_b - 1) < 1e-12);
      if (p.first[Partings::closest][lane] < 1e-6) continue;
      // Parted by as much as they are distant: nothing is closer.
      CHECK(std::abs(between.norm() - p.first[Partings::closest][lane]) < 1e-9);
      ++apart;
    }
    // Tilted directions: the normals, their sum, and these turned towards the closest places.
    TiltedPartings tilted;
    find_tilted(couples[0], p, 0, from, to, tilted);
    const auto direction = [&](int k) { return Vec3(p.normal[k][0][0], p.normal[k][1][0], p.normal[k][2][0]); };
    const Vec3 normals[] = {direction(Partings::a_normal), direction(Partings::b_normal), direction(Partings::a_normal) + direction(Partings::b_normal)};
    for (int k = 0; k < TiltedPartings::count; ++k) {
      const Vec3 n(tilted.normal[0][k], tilted.normal[1][k], tilted.normal[2][k]), wanted = normals[k % 3] + std::array{0.0, 0.01, 0.03, 0.09, 0.27}[static_cast<std::size_t>(k / 3)] * direction(Partings::closest);
      CHECK((n - wanted.normalized()).norm() < 1e-12);
      CHECK(std::abs(parted(n, couples[0].a, couples[0].b, from) - tilted.first[k]) < 1e-12);
      CHECK(std::abs(parted(n, couples[0].a, couples[0].b, to) - tilted.last[k]) < 1e-12);
    }
    on_every_target([&] {
      TiltedPartings same;
      find_tilted(couples[0], p, 0, from, to, same);
      for (int k = 0; k < TiltedPartings::count; ++k) {
        for (int axis = 0; axis < 3; ++axis) CHECK(same.normal[axis][k] == tilted.normal[axis][k]);
        CHECK((same.first[k] == tilted.first[k] && same.last[k] == tilted.last[k]));
      }
      Partings other;
      find_partings(couples.data(), couples.size(), from, to, true, other);
      for (std::size_t lane = 0; lane < couples.size(); ++lane)
        for (int k = 0; k < Partings::count; ++k) {
          for (int axis = 0; axis < 3; ++axis) CHECK(other.normal[k][axis][lane] == p.normal[k][axis][lane]);
          CHECK(other.first[k][lane] == p.first[k][lane]);
          CHECK(other.last[k][lane] == p.last[k][lane]);
          CHECK(other.always[k][lane] == p.always[k][lane]);
        }
    });
  }
  CHECK(apart > 300);
}
