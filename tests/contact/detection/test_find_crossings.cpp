// Crossings of triangles against a double loop over the definition.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/find_crossings.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"

using namespace geo;

TEST_CASE("the sheets of a new crack touch, and cross when one passes through the other") {
  // Both sides of a strip of four triangles: sites 0 to 5, the front at 0 and 1.
  TriangleMesh m;
  for (int copy = 0; copy < 2; ++copy)
    for (int i = 0; i < 6; ++i)
      if (copy == 0 || i >= 2) {
        m.vertices.push_back({double(i % 2), double(i / 2), 0});
        m.site.push_back(static_cast<std::uint32_t>(i));
      }
  const auto other = [](std::uint32_t v) { return v < 2 ? v : v + 4; };
  for (const Triangle t : {Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{2, 3, 4}, Triangle{4, 3, 5}}) {
    m.triangles.push_back(t);
    m.triangles.push_back({other(t[0]), other(t[2]), other(t[1])});
  }
  CHECK(count_crossings(m) == 0);
  for (std::size_t v = 6; v < 10; ++v) m.vertices[v].z() = 0.25;  // opened at the far end, joined at the front
  CHECK(count_crossings(m) == 0);
  m.vertices[9].z() = -0.25;  // one corner passes through the other side
  CHECK(count_crossings(m) > 0);
  m.vertices[9].z() = 0;  // back to its copy: coincident
  CHECK(count_crossings(m) == 0);
  m.vertices[9].x() += 1e-15;  // differs by an ulp, in the plane of the other side: crosses
  m.vertices[8].z() = m.vertices[7].z() = m.vertices[6].z() = 0;
  CHECK(count_crossings(m) > 0);
}

TEST_CASE("spheres cross if and only if they overlap") {
  TriangleMesh two = make_sphere(3);
  const TriangleMesh other = two;
  const auto base = static_cast<std::uint32_t>(two.vertices.size());
  for (const Vec3& p : other.vertices) two.vertices.push_back(p + Vec3(3, 0, 0));
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + base, b + base, c + base});
  CHECK(count_crossings(two) == 0);
  for (std::size_t v = base; v < two.vertices.size(); ++v) two.vertices[v].x() -= 1.5;
  CHECK(count_crossings(two) > 10);
}

TEST_CASE("crossings of crumpled, torn and two-sided surfaces are those of a double loop over the definition") {
  const auto [first, count] = seeds(200);
  std::size_t crossed = 0, clean = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TriangleMesh m = make_sphere(2 + static_cast<int>(random.below(3)));
    const double rough = std::array{0.0, 0.05, 0.3, 1.0}[random.below(4)];
    for (Vec3& p : m.vertices) p += rough * random.uniform() * random.direction();
    const bool two_sided = random.below(2) == 0;
    if (random.below(2) == 0)
      std::erase_if(m.triangles, [&](const Triangle&) { return random.below(8) == 0; });  // open fans
    if (random.below(2) == 0)                                                             // flat: exact answers only
      for (Vec3& p : m.vertices) p.z() = 0;
    // Second sides of some triangles, with copies of their vertices, some of which are displaced.
    std::vector<std::uint32_t> site(m.vertices.size());
    std::iota(site.begin(), site.end(), 0u);
    std::vector<std::uint32_t> copy(m.vertices.size(), ~0u);
    const std::size_t own = random.below(2) == 0 ? m.triangles.size() : 0;
    for (std::size_t t = 0; t < own; ++t) {
      if (random.below(3) != 0) continue;
      Triangle other = m.triangles[t];
      std::swap(other[1], other[2]);
      for (auto& v : other) {
        if (random.below(4) == 0) continue;  // joined there
        if (copy[v] == ~0u) {
          copy[v] = static_cast<std::uint32_t>(m.vertices.size());
          site.push_back(v);
          m.vertices.push_back(random.below(3) == 0 ? Vec3(m.vertices[v] + 0.1 * random.direction())
                                                    : Vec3(m.vertices[v]));
        }
        v = copy[v];
      }
      m.triangles.push_back(other);
    }
    const auto representative = coincident_representatives(site, m.vertices);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> expected;
    const auto represented = [&](std::uint32_t t) {
      return Triangle{representative[m.triangles[t][0]], representative[m.triangles[t][1]],
                      representative[m.triangles[t][2]]};
    };
    for (std::uint32_t s = 0; s < m.triangles.size(); ++s)
      for (std::uint32_t t = s + 1; t < m.triangles.size(); ++t)
        if (triangles_cross(represented(s), represented(t), m.vertices, two_sided)) expected.push_back({s, t});
    CHECK(find_crossings(m.triangles, m.vertices, representative, two_sided) == expected);
    (expected.empty() ? clean : crossed) += 1;
  }
  if (count >= 200) {
    CHECK(crossed > 50);
    CHECK(clean > 2);
  }
}

TEST_CASE("a counter of many surfaces agrees with separate counts, whatever changes between surfaces") {
  const auto [first, count] = seeds(100);
  std::size_t crossed = 0, clean = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TriangleMesh m = make_sphere(2 + static_cast<int>(random.below(2)));
    CrossingCounter counter;
    for (int frame = 0; frame < 8; ++frame) {
      const std::size_t now = counter.count(m);
      CHECK(now == count_crossings(m));
      (now > 0 ? crossed : clean) += 1;
      const double rough = std::array{0.0, 0.02, 0.3}[random.below(3)];
      for (Vec3& p : m.vertices) p += rough * random.uniform() * random.direction();
      const auto some = [&] { return random.below(static_cast<std::uint32_t>(m.triangles.size())); };
      switch (random.below(6)) {
        case 0:
          std::swap(m.triangles[some()], m.triangles[some()]);
          break;
        case 1:
          std::swap(m.triangles[some()][0], m.triangles[some()][0]);
          break;  // the same number of triangles, with other vertices
        case 2:
          m.vertices.push_back(m.vertices[0]);
          break;
        case 3:
          m.triangles.pop_back();
          break;
        default:
          break;
      }
      m.site.clear();
      if (random.below(2) == 0) {
        m.site.resize(m.vertices.size());
        std::iota(m.site.begin(), m.site.end(), 0u);
      }
      std::erase_if(m.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    }
  }
  if (count >= 100) {
    CHECK(crossed > 50);
    CHECK(clean > 50);
  }
}

TEST_CASE("surfaces beyond the range of floats are counted like others") {
  for (const double scale : {1.0, 0x1p100, 0x1p130, 0x1p198}) {  // exact; floats end before 2¹²⁸
    INFO(scale);
    TriangleMesh few;  // each box is larger than the largest float
    few.vertices = {{-1, -1, -1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
    few.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (Vec3& p : few.vertices) p *= scale;
    CHECK(count_crossings(few) == 0);
    TriangleMesh mesh = make_sphere(2);
    CHECK(count_crossings(mesh) == 0);
    const std::size_t first = mesh.vertices.size();
    for (const Triangle& t : std::vector<Triangle>(mesh.triangles))
      mesh.triangles.push_back({t[0] + std::uint32_t(first), t[1] + std::uint32_t(first), t[2] + std::uint32_t(first)});
    for (std::size_t v = 0; v < first; ++v) mesh.vertices.push_back(mesh.vertices[v] + Vec3(0.3, 0.2, 0.1));
    const std::size_t here = count_crossings(mesh);
    for (Vec3& p : mesh.vertices) p *= scale;
    CHECK(here > 10);
    CHECK(count_crossings(mesh) == here);
  }
}
