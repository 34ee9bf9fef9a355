// Separating axes, planes of triangles and the disjointness filter against scalar evaluation.
#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/candidate_axes.h"
#include "contact/detection/disjointness_filter.h"
#include "contact/detection/find_crossings.h"
#include "contact/detection/triangle_planes.h"
#include "simd_targets.h"

using namespace geo;

namespace {

// Triangles of few points, some on a grid: many share corners, lie in one plane, or have no area.
struct Soup {
  std::vector<Triangle> triangles;
  std::vector<Vec3> from, to;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  explicit Soup(Random& random) {
    const bool grid = random.below(2) == 0;
    for (int v = 0; v < 24; ++v) {
      from.push_back(grid ? Vec3(double(random.below(3)), double(random.below(3)), double(random.below(3)))
                          : Vec3(random.uniform(0, 2) * random.direction()));
      to.push_back(grid && random.below(2) == 0 ? from.back()
                                                : Vec3(from.back() + random.uniform(0, 0.5) * random.direction()));
    }
    for (int t = 0; t < 24; ++t) {
      Triangle one;
      for (int k = 0; k < 3; ++k) do
          one[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(random.below(24));
        while ((k > 0 && one[static_cast<std::size_t>(k)] == one[0]) || (k > 1 && one[2] == one[1]));
      triangles.push_back(one);
    }
    for (std::uint32_t s = 0; s < triangles.size(); ++s)
      for (std::uint32_t t = s + 1; t < triangles.size(); ++t) pairs.push_back({s, t});
  }
};

Vec3 centroid_of(const Triangle& t, const std::vector<Vec3>& at) { return (at[t[0]] + at[t[1]] + at[t[2]]) / 3; }

Simplex simplex_of(const Triangle& t) { return {{t[0], t[1], t[2]}, 3}; }

}  // namespace

TEST_CASE("planes and differences of centroids cull exactly the pairs that they separate, for all instruction sets") {
  const auto [first, count] = seeds(40);
  std::size_t separated_by_planes = 0, separated_by_centroids = 0, kept_by_planes = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup soup(random);
    const double at_first = 0.2 * random.uniform(0, 1), at_last = 0.2 * random.uniform(0, 1);
    TrianglePlanes planes(soup.triangles, soup.from, soup.to);
    for (std::size_t v = 0; v < soup.to.size(); ++v)
      if (random.below(4) == 0) soup.to[v] += Vec3(0, 0, 0.1);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) planes.update_end(t);
    // How far a direction parts two, at both ends; of their planes the better one on the side
    // where the motion begins.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> left_by_planes, left_by_centroids;
    const auto left = planes.end_separations(soup.pairs);
    for (std::size_t i = 0; i < soup.pairs.size(); ++i) {
      const auto& [p, q] = soup.pairs[i];
      const Triangle &s = soup.triangles[p], &t = soup.triangles[q];
      bool any = false;
      double farthest = -1e300;
      for (const auto& [a, b] : {std::pair(s, t), std::pair(t, s)}) {
        Vec3 n = (soup.from[a[1]] - soup.from[a[0]]).cross(soup.from[a[2]] - soup.from[a[0]]);
        if (n.norm() > 0) n.normalize();
        for (const double sign : {1.0, -1.0})
          any |= separation_along(sign * n, simplex_of(b), simplex_of(a), soup.from) > at_first &&
                 separation_along(sign * n, simplex_of(b), simplex_of(a), soup.to) > at_last;
        // Only rounding could tell the side else.
        const double side = n.dot(centroid_of(b, soup.from) - centroid_of(a, soup.from));
        farthest =
            std::abs(side) > 1e-9
                ? std::max(farthest, separation_along(side > 0 ? n : Vec3(-n), simplex_of(b), simplex_of(a), soup.to))
                : 1e300;
      }
      if (farthest < 1e300) CHECK(std::abs(left[i] - farthest) < 1e-12);
      if (!any) left_by_planes.push_back(soup.pairs[i]);
      CHECK(planes.separates(p, q, at_first, at_last) == any);
      const Vec3 difference = centroid_of(s, soup.from) - centroid_of(t, soup.from);
      if (!(separation_along(difference, simplex_of(s), simplex_of(t), soup.from) > at_first * difference.norm() &&
            separation_along(difference, simplex_of(s), simplex_of(t), soup.to) > at_last * difference.norm()))
        left_by_centroids.push_back(soup.pairs[i]);
    }
    separated_by_planes += soup.pairs.size() - left_by_planes.size();
    separated_by_centroids += soup.pairs.size() - left_by_centroids.size();
    kept_by_planes += left_by_planes.size();
    for_each_simd_target([&] {
      auto kept = soup.pairs;
      planes.remove_separated(kept, at_first, at_last);
      CHECK(kept == left_by_planes);
      kept = soup.pairs;
      planes.remove_centroid_separated(kept, at_first, at_last);
      CHECK(kept == left_by_centroids);
      CHECK(planes.end_separations(soup.pairs) == left);
    });
  }
  CHECK(separated_by_planes > 100);
  CHECK(separated_by_centroids > 100);
  CHECK(kept_by_planes > 100);
}

TEST_CASE(
    "pairs that the disjointness filter removes do not cross, and it removes most of these, for all instruction sets") {
  const auto [first, count] = seeds(100);
  std::size_t removed = 0, removed_flat = 0, neighbours = 0, neither = 0, crossing = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup soup(random);
    const bool flat = random.below(2) == 0;
    if (flat)  // within rounding of a plane
      for (Vec3& p : soup.from) p[2] = 1 + 0.5 * p[0] + (random.below(3) == 0 ? 1e-16 : 0) * p[1];
    std::vector<std::uint32_t> representative(soup.from.size());
    for (std::uint32_t v = 0; v < representative.size(); ++v) {
      representative[v] = v;
      for (std::uint32_t w = 0; w < v; ++w)
        if (random.below(3) != 0 && soup.from[v] == soup.from[w]) representative[v] = representative[w];
    }
    std::vector<Triangle> represented = soup.triangles;
    for (Triangle& t : represented)
      for (auto& v : t) v = representative[v];
    auto kept = soup.pairs;
    remove_disjoint(represented, soup.from, kept);
    for (const auto& pair : soup.pairs) {
      const Triangle &s = represented[pair.first], &t = represented[pair.second];
      if (s[0] == s[1] || s[1] == s[2] || s[2] == s[0] || t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      const bool is_removed = !std::binary_search(kept.begin(), kept.end(), pair),
                 crosses = triangles_cross(s, t, soup.from, true);
      if (is_removed) CHECK_FALSE(crosses);
      const auto common =
          std::count_if(s.begin(), s.end(), [&](auto v) { return v == t[0] || v == t[1] || v == t[2]; });
      removed += is_removed;
      removed_flat += is_removed && flat;
      neighbours += is_removed && common > 0;
      neither += !is_removed && !crosses;
      crossing += crosses;
    }
    for_each_simd_target([&] {
      auto same = soup.pairs;
      remove_disjoint(represented, soup.from, same);
      CHECK(same == kept);
    });
  }
  CHECK(removed > 1000);
  CHECK(removed_flat > 1000);  // as no planes can tell
  CHECK(neighbours > 100);
  CHECK(neither > 0);
  CHECK(crossing > 100);
}

TEST_CASE("separations of axes are as stated, the largest between closest points, for all instruction sets") {
  const auto [first, count] = seeds(200);
  std::size_t apart = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const bool grid = random.below(3) == 0;  // many parallel edges, and parts that touch
    std::vector<Vec3> from, to;
    std::vector<SimplexPair> pairs;
    const auto somewhere = [&](double scale) {
      return grid ? Vec3(double(random.below(3)), double(random.below(3)), double(random.below(3)))
                  : Vec3(scale * random.uniform(0, 1) * random.direction());
    };
    for (std::uint32_t c = 0; c < 1 + random.below(CandidateAxes::width); ++c) {
      const auto simplex = [&](double x) {
        Simplex s{{}, 1 + static_cast<int>(random.below(3))};
        for (int k = 0; k < s.size; ++k) {
          s.v[k] = static_cast<std::uint32_t>(from.size());
          from.push_back(Vec3(x, 0, 0) + somewhere(1));
          to.push_back(from.back() + somewhere(0.3));
        }
        return s;
      };
      const Simplex a = simplex(0), b = simplex(grid ? random.below(4) : random.uniform(0.5, 2.5));
      pairs.push_back({a, b});
    }
    CandidateAxes p;
    find_candidate_axes(pairs.data(), pairs.size(), from, to, true, p);
    for (std::size_t lane = 0; lane < pairs.size(); ++lane) {
      const auto& [a, b] = pairs[lane];
      for (int k = 0; k < CandidateAxes::count; ++k) {
        const Vec3 n(p.normal[k][0][lane], p.normal[k][1][lane], p.normal[k][2][lane]);
        CHECK((n.isZero(0) || std::abs(n.norm() - 1) < 1e-12));
        CHECK(std::abs(separation_along(n, a, b, from) - p.start_separation[k][lane]) < 1e-12);
        CHECK(std::abs(separation_along(n, a, b, to) - p.end_separation[k][lane]) < 1e-12);
        CHECK(p.swept_separation[k][lane] <= std::min(p.start_separation[k][lane], p.end_separation[k][lane]));
        CHECK(p.start_separation[k][lane] <=
              std::max(0.0, p.start_separation[CandidateAxes::between_closest][lane]) + 1e-9);
        CHECK(p.end_separation[k][lane] <=
              std::max(0.0, p.end_separation[CandidateAxes::between_closest_at_end][lane]) + 1e-9);
      }
      const auto corners = [&](const Simplex& s, Vec3(&out)[3]) {
        for (int k = 0; k < 3; ++k) out[k] = from[s.v[std::min(k, s.size - 1)]];
      };
      Vec3 s[3], t[3], between = Vec3::Zero();
      corners(a, s);
      corners(b, t);
      double of_a = 0, of_b = 0;
      for (int k = 0; k < 3; ++k) {
        CHECK(p.weights_a[k][lane] >= 0);
        CHECK(p.weights_b[k][lane] >= 0);
        between += p.weights_a[k][lane] * s[k] - p.weights_b[k][lane] * t[k];
        of_a += p.weights_a[k][lane];
        of_b += p.weights_b[k][lane];
      }
      CHECK(std::abs(of_a - 1) + std::abs(of_b - 1) < 1e-12);
      if (p.start_separation[CandidateAxes::between_closest][lane] < 1e-6) continue;
      // Separated by their distance: no points are closer.
      CHECK(std::abs(between.norm() - p.start_separation[CandidateAxes::between_closest][lane]) < 1e-9);
      ++apart;
    }
    // Tilted directions: the normals, their sum, and these turned towards the closest places.
    TiltedAxes tilted;
    find_tilted_axes(pairs[0], p, 0, from, to, tilted);
    const auto direction = [&](int k) { return Vec3(p.normal[k][0][0], p.normal[k][1][0], p.normal[k][2][0]); };
    const Vec3 normals[] = {direction(CandidateAxes::a_normal), direction(CandidateAxes::b_normal),
                            direction(CandidateAxes::a_normal) + direction(CandidateAxes::b_normal)};
    for (int k = 0; k < TiltedAxes::count; ++k) {
      const Vec3 n(tilted.normal[0][k], tilted.normal[1][k], tilted.normal[2][k]),
          wanted = normals[k % 3] + std::array{0.0, 0.01, 0.03, 0.09, 0.27}[static_cast<std::size_t>(k / 3)] *
                                        direction(CandidateAxes::between_closest);
      CHECK((n - wanted.normalized()).norm() < 1e-12);
      CHECK(std::abs(separation_along(n, pairs[0].a, pairs[0].b, from) - tilted.start_separation[k]) < 1e-12);
      CHECK(std::abs(separation_along(n, pairs[0].a, pairs[0].b, to) - tilted.end_separation[k]) < 1e-12);
    }
    for_each_simd_target([&] {
      TiltedAxes same;
      find_tilted_axes(pairs[0], p, 0, from, to, same);
      for (int k = 0; k < TiltedAxes::count; ++k) {
        for (int axis = 0; axis < 3; ++axis) CHECK(same.normal[axis][k] == tilted.normal[axis][k]);
        CHECK((same.start_separation[k] == tilted.start_separation[k] &&
               same.end_separation[k] == tilted.end_separation[k]));
      }
      CandidateAxes other;
      find_candidate_axes(pairs.data(), pairs.size(), from, to, true, other);
      for (std::size_t lane = 0; lane < pairs.size(); ++lane)
        for (int k = 0; k < CandidateAxes::count; ++k) {
          for (int axis = 0; axis < 3; ++axis) CHECK(other.normal[k][axis][lane] == p.normal[k][axis][lane]);
          CHECK(other.start_separation[k][lane] == p.start_separation[k][lane]);
          CHECK(other.end_separation[k][lane] == p.end_separation[k][lane]);
          CHECK(other.swept_separation[k][lane] == p.swept_separation[k][lane]);
        }
    });
  }
  CHECK(apart > 300);
}
