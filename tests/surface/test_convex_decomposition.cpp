#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

double volume_of(const std::vector<TriangleMesh>& parts) {
  double sum = 0;
  for (const auto& part : parts) sum += signed_volume(part);
  return sum;
}

}  // namespace

TEST_CASE("Convex parts are closed, cover the mesh and hold less air the more they are", "[parts]") {
  const auto [first, count] = seeds(1);
  for (const TriangleMesh& mesh :
       {make_letter('L', 0.3, 12), make_letter('K', 0.3, 12), make_polyp(5), make_apple(5)}) {
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t most : {1, 2, 4, 8}) {
      const auto parts = convex_decomposition(mesh, most, ~std::size_t(0));
      CHECK((!parts.empty() && parts.size() <= most));
      CHECK(volume_of(parts) <= before);
      CHECK(volume_of(parts) >= signed_volume(mesh) * (1 - 1e-12));
      before = volume_of(parts);
      for (const auto& part : parts) CHECK(check_surface(part, SelfIntersections::find).first_problem == "");
      std::vector<TriangleBvh> trees;
      for (const auto& part : parts) trees.emplace_back(corners_of(part));
      const TriangleBvh whole(corners_of(mesh));
      Random random(first + static_cast<std::uint64_t>(count) * most);
      for (int i = 0; i < 300; ++i) {
        Vec3 p;
        for (int k = 0; k < 3; ++k) p[k] = random.uniform(whole.box().lo[k], whole.box().hi[k]);
        if (!whole.inside(p)) continue;
        bool covered = false;
        for (const auto& tree : trees) covered = covered || tree.inside(p) || tree.closest(p).distance < 1e-12;
        INFO("seed " << first << ", point " << p.transpose());
        REQUIRE(covered);
      }
    }
  }
}

TEST_CASE("A letter L is two blocks, nearly, and a ball is one part", "[parts]") {
  const TriangleMesh letter = make_letter('L', 0.3, 16);
  const auto one = convex_decomposition(letter, 1, 64), two = convex_decomposition(letter, 2, 64);
  REQUIRE((one.size() == 1 && two.size() == 2));
  CHECK(volume_of(one) > 1.5 * signed_volume(letter));
  CHECK(volume_of(two) < 1.15 * signed_volume(letter));
  CHECK(convex_decomposition(make_sphere(4), 8, ~std::size_t(0)).size() == 1);
  for (const auto& part : convex_decomposition(make_polyp(6), 6, 12)) CHECK(part.vertices.size() <= 12);
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  CHECK(convex_decomposition(flat, 4, 64).empty());
}
