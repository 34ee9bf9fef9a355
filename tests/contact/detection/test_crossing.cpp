#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/close_pairs.h"
#include "kerf/crossing.h"
#include "kerf/parallel.h"
#include "kerf/shapes.h"
#include "vectors.h"

using namespace geo;

TEST_CASE("a fresh crack's sheets touch, and cross once one is pushed through the other") {
  // A strip of four triangles, both sides of it: sites 0..5, the front at 0, 1.
  TriangleMesh m;
  for (int copy = 0; copy < 2; ++copy)
    for (int i = 0; i < 6; ++i)
      if (copy == 0 || i >= 2)
        m.vertices.push_back({double(i % 2), double(i / 2), 0}), m.site.push_back(static_cast<std::uint32_t>(i));
  const auto other = [](std::uint32_t v) { return v < 2 ? v : v + 4; };
  for (const Triangle t : {Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{2, 3, 4}, Triangle{4, 3, 5}})
    m.triangles.push_back(t), m.triangles.push_back({other(t[0]), other(t[2]), other(t[1])});
  CHECK(count_crossings(m) == 0);
  for (std::size_t v = 6; v < 10; ++v) m.vertices[v].z() = 0.25;  // opened at the far end, joined at the front
  CHECK(count_crossings(m) == 0);
  m.vertices[9].z() = -0.25;  // one corner of one side through the other side
  CHECK(count_crossings(m) > 0);
  m.vertices[9].z() = 0;  // back where its copy is: together
  CHECK(count_crossings(m) == 0);
  m.vertices[9].x() += 1e-15;  // not to the bit, and in the plane of the other side: that crosses
  m.vertices[8].z() = m.vertices[7].z() = m.vertices[6].z() = 0;
  CHECK(count_crossings(m) > 0);
}

TEST_CASE("crossings of a plain mesh are those of the definition") {
  TriangleMesh two = make_sphere(3);
  const TriangleMesh other = two;
  const auto base = static_cast<std::uint32_t>(two.vertices.size());
  for (const Vec3& p : other.vertices) two.vertices.push_back(p + Vec3(3, 0, 0));
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + base, b + base, c + base});
  CHECK(count_crossings(two) == 0);
  for (std::size_t v = base; v < two.vertices.size(); ++v) two.vertices[v].x() -= 1.5;
  CHECK(count_crossings(two) > 10);
}

TEST_CASE("crossings of crumpled, torn and doubled surfaces are those that a double loop of the definition finds") {
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
    // Other sides of some, with vertices of their own at the same sites, some of them elsewhere.
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
          copy[v] = static_cast<std::uint32_t>(m.vertices.size()), site.push_back(v);
          m.vertices.push_back(random.below(3) == 0 ? Vec3(m.vertices[v] + 0.1 * random.direction())
                                                    : Vec3(m.vertices[v]));
        }
        v = copy[v];
      }
      m.triangles.push_back(other);
    }
    const auto together = vertices_together(site, m.vertices);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> expected;
    const auto standing = [&](std::uint32_t t) {
      return Triangle{together[m.triangles[t][0]], together[m.triangles[t][1]], together[m.triangles[t][2]]};
    };
    for (std::uint32_t s = 0; s < m.triangles.size(); ++s)
      for (std::uint32_t t = s + 1; t < m.triangles.size(); ++t)
        if (triangles_cross(standing(s), standing(t), m.vertices, two_sided)) expected.push_back({s, t});
    CHECK(find_crossings(m.triangles, m.vertices, together, two_sided) == expected);
    (expected.empty() ? clean : crossed) += 1;
  }
  if (count >= 200) {
    CHECK(crossed > 50);
    CHECK(clean > 2);
  }
}

TEST_CASE(
    "crossings are counted one surface after the other as each for itself, whether triangles, places, sites or the "
    "number of vertices have changed") {
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
          break;  // as many triangles, of other vertices
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

TEST_CASE("what is larger than all floats is counted like anything else") {
  for (const double scale : {1.0, 0x1p100, 0x1p130, 0x1p198}) {  // exact; floats end before 2¹²⁸
    INFO(scale);
    TriangleMesh few;  // each of whose boxes is larger than all floats
    few.vertices = {{-1, -1, -1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}},
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

TEST_CASE("pairs of boxes are those that a double loop finds") {
  const auto [first, cases] = seeds(60);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(cases); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Box3> boxes;
    // Some hundreds have blocks of blocks of blocks.
    const std::uint32_t count = random.below(4) == 0 ? 10 + static_cast<std::uint32_t>(random.below(1000)) : 150;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const double size = random.below(10) == 0 ? random.uniform(0, 1) : random.uniform(0, 0.1);
      boxes.push_back(random.below(20) == 0
                          ? Box3()
                          : Box3{p, p + size * Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1))});
      if (random.below(5) == 0 && !boxes.back().empty()) boxes.push_back(boxes.back());
    }
    std::vector<std::uint8_t> some;
    for (std::size_t i = 0; i < boxes.size(); ++i) some.push_back(random.below(4) == 0);
    const auto expected = [&](bool only) {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
          if (!boxes[i].empty() && !boxes[j].empty() && boxes[i].meets(boxes[j]) && (!only || some[i] || some[j]))
            pairs.push_back({i, j});
      return pairs;
    };
    const auto sorted = [](std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
      std::sort(pairs.begin(), pairs.end());
      return pairs;
    };
    CHECK(sorted(close_pairs(boxes)) == expected(false));
    CHECK(sorted(close_pairs(boxes, &some)) == expected(true));
    // Some become larger, also beyond the room that all had.
    BoxTree tree(boxes);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].empty() || random.below(10) != 0) continue;
      const Vec3 p(random.uniform(-3, 3), random.uniform(-1, 1), random.uniform(-1, 1));
      tree.enlarge(i, {p, p}), boxes[i].add(p);
    }
    const auto all = tree.pairs(), with_some = tree.pairs(&some);
    CHECK(sorted(all) == expected(false));
    CHECK(sorted(with_some) == expected(true));
    on_every_target([&] {
      CHECK(tree.pairs() == all);
      CHECK(tree.pairs(&some) == with_some);
    });
    // All go elsewhere, some far, or all so far that floats hardly tell them apart; one that was empty keeps the tree
    // from following.
    std::vector<Box3> others = boxes;
    const Vec3 all_by =
        random.below(3) == 0 ? Vec3(std::pow(10.0, random.uniform(0, 9)) * random.direction()) : Vec3(Vec3::Zero());
    for (Box3& b : others) {
      const Vec3 by = all_by + random.uniform(0, random.below(10) == 0 ? 4 : 0.1) * random.direction();
      if (!b.empty()) b.lo += by, b.hi += by;
    }
    boxes = others;
    REQUIRE(tree.replace(others));
    CHECK(sorted(tree.pairs()) == expected(false));
    CHECK(sorted(tree.pairs(&some)) == expected(true));
    const auto empty = std::find_if(boxes.begin(), boxes.end(), [](const Box3& b) { return b.empty(); });
    if (empty == boxes.end()) continue;
    others = boxes, others[static_cast<std::size_t>(empty - boxes.begin())].add(Vec3::Zero());
    CHECK(!tree.replace(others));
    CHECK(sorted(tree.pairs()) == expected(false));
  }
}

TEST_CASE(
    "pairs of many boxes are the same in the same order for any number of threads, also after all were replaced") {
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Random random(5);
  std::vector<Box3> first, then;
  std::vector<std::uint8_t> some;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
        by = random.uniform(0, 0.1) * random.direction();
    const Vec3 size = 0.1 * Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    const bool none = random.below(50) == 0;
    first.push_back(none ? Box3() : Box3{p, p + size});
    then.push_back(none || random.below(10) == 0 ? Box3() : Box3{p + by, p + by + size});
    some.push_back(random.below(4) == 0);
  }
  const auto same = [](const std::vector<Box3>& a, const std::vector<Box3>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Box3& p, const Box3& q) { return p.lo == q.lo && p.hi == q.hi; });
  };
  const auto run = [&] {
    BoxTree tree(first);
    std::vector<Pairs> found{tree.pairs(), tree.pairs(&some)};
    // What is refused changes nothing on either side: a box where there was none, one too few, one too many.
    auto wrong = then;
    wrong[static_cast<std::size_t>(std::find_if(first.begin(), first.end(), [](const Box3& b) { return b.empty(); }) -
                                   first.begin())]
        .add(Vec3::Zero());
    for (const auto& refused :
         {wrong, std::vector<Box3>(then.begin(), then.end() - 1), std::vector<Box3>(then.size() + 1)}) {
      auto given = refused;
      CHECK(!tree.replace(given));
      CHECK(same(given, refused));
      CHECK(same(tree.boxes(), first));
      CHECK(tree.pairs() == found[0]);
    }
    auto given = then;
    REQUIRE(tree.replace(given));
    CHECK(same(tree.boxes(), then));
    found.push_back(tree.pairs()), found.push_back(tree.pairs(&some));
    return found;
  };
  set_threads(1);
  const auto alone = run();
  set_threads(3);
  CHECK(run() == alone);
  set_threads(0);
  CHECK(alone[0].size() > 5000);
  // One that is made of the others finds the same pairs.
  const BoxTree anew(then);
  for (const bool asked : {false, true}) {
    auto replaced = alone[asked ? 3 : 2], expected = anew.pairs(asked ? &some : nullptr);
    std::sort(replaced.begin(), replaced.end()), std::sort(expected.begin(), expected.end());
    CHECK(replaced == expected);
  }
}
