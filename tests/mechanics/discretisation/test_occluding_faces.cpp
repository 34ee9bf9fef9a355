// Faces that hide nodes, kept from cut to cut.
#include "mechanics/discretisation/occluding_faces.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/discretisation/random_cracks.h"

using namespace geo;

namespace {

Vec3 random_point(Random& random) {
  return {random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1)};
}

}  // namespace

TEST_CASE("kept faces block what a tree over them blocks, through cuts and steps made undone", "[supports]") {
  const auto [first, count] = seeds(40);
  std::size_t blocked = 0, free = 0, kept = 0;
  for (int n = 0; n < count; ++n) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(n);
    INFO("seed " << seed);
    Random random(seed);
    Complex surface = Complex::from_skin(make_block({1, 1, 1}, random.uniform(0.1, 0.3)));
    OccludingFaces faces;
    CHECK(faces.empty());
    grow_cracks(surface, random, 3, 4, 0.1, 0.3, [&](const FrontState&, const CrackDelta&) {
      const Vec3 middle = random_point(random);
      const Box3 box = Box3{middle, middle}.grown(random.uniform(0.2, 1.2));
      const std::vector<FaceId> alive = living_faces(surface);
      std::vector<FaceId> near = alive;
      std::erase_if(near, [&](FaceId f) { return !surface.box(f).meets(box); });
      faces.update(surface, near);
      const TriangleBvh least = tree_over(surface, near), most = tree_over(surface, alive);
      for (int i = 0; i < 20; ++i) {
        const Vec3 p = random_point(random);
        std::vector<Vec3> ends(1 + random.below(40));
        for (Vec3& q : ends) q = p + random.uniform(0.01, 0.5) * random.direction();
        std::vector<std::uint8_t> result(ends.size(), 2), at_least = result, at_most = result;
        faces.blocks(p, ends, result.data());
        least.blocks(p, ends, at_least.data());
        most.blocks(p, ends, at_most.data());
        for (std::size_t e = 0; e < ends.size(); ++e) {
          CHECK(at_least[e] <= result[e]);
          CHECK(result[e] <= at_most[e]);
          blocked += result[e] == 1;
          free += result[e] == 0;
          kept += result[e] != at_least[e];
        }
      }
    });
  }
  CHECK(blocked > 1000);
  CHECK(free > 1000);
  CHECK(kept > 0);  // faces of earlier sets that are alive
}

TEST_CASE("a set of no faces blocks nothing", "[supports]") {
  const Complex surface = Complex::from_skin(make_block({1, 1, 1}, 0.5));
  OccludingFaces faces;
  const std::vector<Vec3> ends{{2, 2, 2}};
  std::uint8_t result = 2;
  faces.blocks({-1, -1, -1}, ends, &result);
  CHECK(result == 0);
  faces.update(surface, {});
  CHECK(faces.empty());
  const std::vector<FaceId> one{FaceId(0u)};
  faces.update(surface, one);
  CHECK_FALSE(faces.empty());
}
