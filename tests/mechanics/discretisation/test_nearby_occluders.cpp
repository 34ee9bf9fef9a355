// Occluders near points, kept from cut to cut.
#include "mechanics/discretisation/nearby_occluders.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/discretisation/random_cracks.h"

using namespace geo;

namespace {

Vec3 point_in(const Box3& box, Random& random) {
  return box.lo + Vec3(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(box.hi - box.lo);
}

bool has(std::span<const FrontEdge> edges, const FrontEdge& edge) {
  return std::any_of(edges.begin(), edges.end(),
                     [&](const FrontEdge& e) { return e.a == edge.a && e.b == edge.b && e.ahead == edge.ahead; });
}

}  // namespace

TEST_CASE("kept occluders block in their boxes what all faces block, through cuts and steps made undone",
          "[supports]") {
  const auto [first, count] = seeds(40);
  std::size_t blocked = 0, free = 0, fronts = 0;
  for (int n = 0; n < count; ++n) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(n);
    INFO("seed " << seed);
    Random random(seed);
    Complex surface = Complex::from_skin(make_block({1, 1, 1}, random.uniform(0.1, 0.3)));
    NearbyOccluders kept;
    const double margin = random.uniform(0, 0.4);
    grow_cracks(surface, random, 2, 6, 0.05, 0.2, [&](const FrontState& front, const CrackDelta& delta) {
      if (!delta.empty()) kept.note_changes(delta.new_faces);
      if (random.below(4) == 0) return;  // several steps are noted before a query
      const std::vector<FaceId> alive = living_faces(surface);
      const TriangleBvh all = tree_over(surface, alive);
      // As points move with the front: beside it, and now and then elsewhere.
      std::vector<Box3> boxes;
      for (std::uint32_t i = 0; i < 1 + random.below(3); ++i) {
        const Vec3 middle = random.below(5) == 0
                                ? point_in({{0, 0, 0}, {1, 1, 1}}, random)
                                : Vec3(front.points[random.below(std::uint32_t(front.points.size()))].position);
        boxes.push_back(Box3{middle, middle}.grown(random.uniform(0.02, 0.3)));
      }
      const Occluders& near = kept.near(surface, boxes, margin);
      for (const Box3& box : boxes) {
        for (int i = 0; i < 10; ++i) {
          const Vec3 p = point_in(box, random);
          std::vector<Vec3> ends(1 + random.below(40));
          for (Vec3& q : ends) q = point_in(box, random);
          std::vector<std::uint8_t> result(ends.size(), 2), expected = result;
          near.faces.blocks(p, ends, result.data());
          all.blocks(p, ends, expected.data());
          CHECK(result == expected);
          const auto hidden = static_cast<std::size_t>(std::count(expected.begin(), expected.end(), 1));
          blocked += hidden;
          free += ends.size() - hidden;
        }
        std::vector<FaceId> in_box = alive;
        std::erase_if(in_box, [&](FaceId f) { return !surface.box(f).meets(box); });
        for (const FrontEdge& edge : front_edges(surface, in_box)) {
          CHECK(has(near.fronts, edge));
          ++fronts;
        }
      }
    });
  }
  CHECK(blocked > 1000);
  CHECK(free > 1000);
  CHECK(fronts > 100);
}
