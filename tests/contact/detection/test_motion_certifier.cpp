// Certified motions: what is certified does not cross at any time of the motion.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/find_crossings.h"
#include "contact/detection/motion_certifier.h"
#include "contact/detection/surface_motion.h"

using namespace geo;

namespace {

// Separate triangles on a grid that do not cross at the start, and move at random.
struct Triangles {
  std::vector<Triangle> triangles;
  std::vector<Vec3> from, to;
  std::vector<std::uint32_t> itself;
  std::vector<TrianglePair> pairs;

  Triangles(Random& random, std::uint32_t count, double size, double move) {
    while (triangles.size() < count) {
      const auto base = static_cast<std::uint32_t>(from.size());
      const Vec3 at(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
      for (int k = 0; k < 3; ++k) from.push_back(at + size * random.direction());
      triangles.push_back({base, base + 1, base + 2});
      for (std::uint32_t t = 0; t + 1 < triangles.size(); ++t)
        if (triangles_cross(triangles[t], triangles.back(), from, false)) {
          triangles.pop_back();
          from.resize(base);
          break;
        }
    }
    for (const Vec3& p : from) to.push_back(p + move * random.uniform(0, 1) * random.direction());
    itself.resize(from.size());
    std::iota(itself.begin(), itself.end(), 0u);
    for (std::uint32_t s = 0; s < count; ++s)
      for (std::uint32_t t = s + 1; t < count; ++t) pairs.push_back({s, t});
  }
};

bool crosses_in_motion(const Triangles& m, const std::vector<Vec3>& to, const TrianglePair& pair) {
  constexpr int samples = 32;
  std::vector<Vec3> at(m.from.size());
  for (int i = 0; i <= samples; ++i) {
    const double share = double(i) / samples;
    for (const auto t : {pair.first, pair.second})
      for (const auto v : m.triangles[t]) at[v] = (1 - share) * m.from[v] + share * to[v];
    if (triangles_cross(m.triangles[pair.first], m.triangles[pair.second], at, false)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("pairs that cross at some time of a motion are uncertified, also after its end has changed", "[certifier]") {
  const auto [first, count] = seeds(12);
  std::size_t certified = 0, uncertified = 0, crossing = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Triangles m(random, 16, 0.2, 0.4);
    std::vector<Vec3> next = m.to;
    const SurfaceMotion motion{m.triangles, m.itself, m.from, m.to};
    const RepresentativeSurface surface(motion);
    const VertexFans fans(m.triangles, m.from.size());
    TrianglePlanes planes;
    MotionCertifier certifier({surface, fans, m.itself, false, m.from, next, 1e-14}, planes);
    std::vector<std::uint8_t> changed(m.triangles.size(), 1);
    const auto unknown = [](std::uint32_t, std::uint32_t, double) { return false; };
    for (int call = 0; call < 3; ++call) {
      const auto found = certifier.uncertified_pairs(m.pairs, changed, unknown);
      REQUIRE(std::is_sorted(found.begin(), found.end()));
      for (const auto& pair : m.pairs) {
        if (!changed[pair.first] && !changed[pair.second]) {
          REQUIRE_FALSE(std::binary_search(found.begin(), found.end(), pair));
          continue;
        }
        const bool is_certified = !std::binary_search(found.begin(), found.end(), pair),
                   crosses = crosses_in_motion(m, next, pair);
        if (is_certified) REQUIRE_FALSE(crosses);
        certified += is_certified;
        uncertified += !is_certified;
        crossing += crosses;
      }
      // Some triangles go elsewhere.
      for (std::size_t t = 0; t < m.triangles.size(); ++t) {
        changed[t] = random.below(3) == 0;
        if (changed[t])
          for (const auto v : m.triangles[t]) next[v] += 0.1 * random.direction();
      }
    }
  }
  if (count >= 12) {
    CHECK(certified > uncertified);  // most pairs are far apart
    CHECK(uncertified > crossing);
    CHECK(crossing > 20);
  }
}

TEST_CASE("pairs known to be disjoint are left to the exact test at the end", "[certifier]") {
  // A triangle that moves straight through another and ends beyond it.
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  std::vector<Vec3> from{{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}, {0, 0, 1}, {0.2, 0, 1}, {0, 0.2, 1}}, to = from;
  for (int v = 3; v < 6; ++v) to[static_cast<std::size_t>(v)].z() = -1;
  const std::vector<std::uint32_t> itself{0, 1, 2, 3, 4, 5};
  const std::vector<TrianglePair> pairs{{0, 1}};
  const std::vector<std::uint8_t> all{1, 1};
  const RepresentativeSurface surface(SurfaceMotion{triangles, itself, from, to});
  const VertexFans fans(triangles, from.size());
  const auto run = [&](bool known) {
    TrianglePlanes planes;
    MotionCertifier certifier({surface, fans, itself, false, from, to, 1e-14}, planes);
    double distance = 0;
    const auto found = certifier.uncertified_pairs(pairs, all, [&](std::uint32_t, std::uint32_t, double d) {
      distance = d;
      return known;
    });
    CHECK(distance == Approx(1));
    return found;
  };
  CHECK(run(false) == pairs);
  CHECK(run(true).empty());
  for (int v = 3; v < 6; ++v) to[static_cast<std::size_t>(v)].z() = v == 3 ? 1 : -1;  // ends across the first
  to[3] = {0, 0, 1};
  CHECK(run(true) == pairs);
}

TEST_CASE("coincident vertices make triangles neighbours", "[certifier]") {
  // Two triangles with a common corner that are two vertices of the surface at one place.
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const std::vector<Vec3> from{{0, 0, 0},  {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 0},
                               {0, -1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}};
  const std::vector<std::uint32_t> representative{0, 1, 2, 0, 4, 5, 6, 7, 8};
  const RepresentativeSurface surface(SurfaceMotion{triangles, representative, from, from});
  CHECK(surface.triangles[1] == Triangle{0, 4, 5});
  CHECK(surface.vertices == std::vector<std::uint32_t>{0, 1, 2, 4, 5, 6, 7, 8});
  CHECK(surface.share_representative(0, 1));
  CHECK_FALSE(surface.share_representative(0, 2));
  const Box3 box = surface.swept_box(2, from, from);
  CHECK((box.lo + surface.target_centroid - Vec3(5, 5, 5)).norm() < 1e-12);
  CHECK((box.hi + surface.target_centroid - Vec3(6, 6, 5)).norm() < 1e-12);
}
