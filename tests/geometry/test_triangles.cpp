// Triangle against triangle, against CGAL's exact kernel on random and on grid triangles, where
// every degeneracy occurs.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/predicates.h"
#include "geometry/triangle_index.h"

using namespace geo;

namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
Exact::Triangle_3 exact(const Vec3 (&t)[3]) {
  const auto p = [](const Vec3& v) { return Exact::Point_3(v.x(), v.y(), v.z()); };
  return {p(t[0]), p(t[1]), p(t[2])};
}

void random_pair(Random& random, Vec3 (&s)[3], Vec3 (&t)[3]) {
  const int grid = random.below(3) ? 3 : 0;  // 0: anywhere
  const auto point = [&] {
    return grid ? Vec3(double(random.below(3)), double(random.below(3)), double(random.below(3)))
                : Vec3(random.uniform(), random.uniform(), random.uniform());
  };
  for (auto* x : {&s, &t}) do
      for (Vec3& p : *x) p = point();
    while (collinear((*x)[0], (*x)[1], (*x)[2]));
  const int shared = static_cast<int>(random.below(3));
  for (int k = 0; k < shared; ++k)
    if (!collinear(k == 0 ? s[0] : t[0], k == 1 ? s[1] : t[1], t[2])) t[k] = s[k];
}

}  // namespace

TEST_CASE("two triangles meet when CGAL says so") {
  const std::uint64_t seed = GENERATE(1, 2, 3);
  CAPTURE(seed);
  Random random(seed);
  int met = 0;
  for (int i = 0; i < cases(4000); ++i) {
    CAPTURE(i);
    Vec3 s[3], t[3];
    random_pair(random, s, t);
    if (collinear(t[0], t[1], t[2])) continue;
    const bool expected = CGAL::do_intersect(exact(s), exact(t));
    met += expected;
    REQUIRE(triangles_meet(s, t) == expected);
  }
  CHECK(met > 500);
}

TEST_CASE("the filter for shared corners is right where it is conclusive") {
  const std::uint64_t seed = GENERATE(4, 5, 6);
  CAPTURE(seed);
  Random random(seed);
  int conclusive = 0;
  for (int i = 0; i < cases(4000); ++i) {
    CAPTURE(i);
    Vec3 s[3], t[3];
    random_pair(random, s, t);
    if (random.below(2))
      for (auto* x : {&s, &t})
        for (Vec3& p : *x) p.z() = 0;  // in one plane
    if (collinear(s[0], s[1], s[2]) || collinear(t[0], t[1], t[2]) || !share_corners_only(s, t)) continue;
    ++conclusive;
    std::vector<Vec3> shared;
    for (const Vec3& p : s)
      for (const Vec3& q : t)
        if (p == q) shared.push_back(p);
    const auto common = CGAL::intersection(exact(s), exact(t));
    const auto is_shared = [&](const Exact::Point_3& p) {
      return std::any_of(shared.begin(), shared.end(),
                         [&](const Vec3& v) { return Exact::Point_3(v.x(), v.y(), v.z()) == p; });
    };
    if (!common) {
      REQUIRE(shared.empty());
    } else if (const auto* p = boost::get<Exact::Point_3>(&*common)) {
      REQUIRE(is_shared(*p));
    } else {
      const auto* segment = boost::get<Exact::Segment_3>(&*common);
      REQUIRE(segment);
      REQUIRE((is_shared(segment->source()) && is_shared(segment->target())));
    }
  }
  CHECK(conclusive > 200);
}

TEST_CASE("the index finds every box that a triangle meets") {
  const std::uint64_t seed = GENERATE(7, 8);
  CAPTURE(seed);
  Random random(seed);
  TriangleIndex index;
  std::vector<std::array<Vec3, 3>> all;
  const auto triangle = [&](double size) {
    const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    return std::array<Vec3, 3>{p, Vec3(p + size * random.direction()), Vec3(p + size * random.direction())};
  };
  for (std::uint32_t i = 0; i < 400; ++i) {
    all.push_back(triangle(0.1));
    index.insert(i, box_of(all[i][0], all[i][1], all[i][2]));
  }
  for (std::uint32_t i = 0; i < 400; i += 3) index.erase(i);
  for (int q = 0; q < cases(200); ++q) {
    const auto t = triangle(q % 3 ? 0.3 : 2.0);
    std::vector<std::uint32_t> found;
    index.find_near_triangle(t[0], t[1], t[2], 0, found);
    REQUIRE(std::is_sorted(found.begin(), found.end()));
    for (std::uint32_t i = 0; i < 400; ++i) {
      if (i % 3 == 0) continue;
      const Vec3 s[3] = {all[i][0], all[i][1], all[i][2]}, u[3] = {t[0], t[1], t[2]};
      if (triangles_meet(s, u)) REQUIRE(std::binary_search(found.begin(), found.end(), i));
    }
  }
}

TEST_CASE("the index is right while boxes of all sizes are inserted and erased") {
  const std::uint64_t seed = GENERATE(11, 12, 13, 14);
  CAPTURE(seed);
  Random random(seed);
  const Vec3 shift = seed % 2 ? Vec3(1e6, -1e6, 3) : Vec3::Zero();
  const double scale = seed % 3 ? 1 : 1e-6;
  TriangleIndex index;
  std::vector<Box3> boxes(600);
  // Coarser and finer levels come up as it goes on; many boxes share a cell.
  const auto box = [&](int step) {
    const double reach = std::min(12, step / 100);
    const double size = scale * std::exp2(random.uniform(-reach, 0.5 * reach));
    Box3 b;
    b.add(shift + scale * (random.below(3) == 0 ? 8.0 : 0.5) * random.uniform() * random.direction());
    b.add(b.lo + size * random.uniform() * random.direction());
    return b;
  };
  for (int step = 0; step < cases(3000); ++step) {
    const auto id = static_cast<std::uint32_t>(random.below(boxes.size()));
    const bool empties = step % 1000 > 800;
    if (!boxes[id].empty()) {
      index.erase(id);
      boxes[id] = Box3{};
    } else if (!empties)
      index.insert(id, boxes[id] = box(step));
    REQUIRE(index.contains(id) == !boxes[id].empty());
    if (step % 5) continue;
    const Box3 query = box(step);
    std::vector<std::uint32_t> found, expected;
    index.find(query, found);
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
      if (!boxes[i].empty() && boxes[i].meets(query)) expected.push_back(i);
    REQUIRE(found == expected);
  }
}
