// Walls that nodes do not resolve.
#include <catch2/catch.hpp>

#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

ThinMaterial thin_in(const TriangleMesh& mesh, double spacing, int across = 0) {
  SampleOptions options;
  options.spacing = spacing;
  options.levels = 1;
  options.across = across;
  return find_thin_material(mesh, sample_nodes(mesh, options));
}

}  // namespace

TEST_CASE("walls with fewer than two nodes across are found, with the spacing that they need") {
  const TriangleMesh sheet = make_block({1, 0.7, 0.04}, 0.1);
  const ThinMaterial thin = thin_in(sheet, 0.05);
  // All but the four rims: 2 · 0.7 of 2 · 0.7 + 2 · 0.04 · 1.7.
  CHECK(thin.share == Approx(1.4 / 1.536).epsilon(1e-6));
  CHECK(thin.thickness == Approx(0.04).epsilon(1e-9));
  CHECK(thin.enough == Approx(0.02).epsilon(1e-9));
  CHECK(thin.spacing == Approx(0.05));
  CHECK((thin.at.z() > 0 && thin.at.z() < 0.04));
  // The spacing that is named suffices, and so do finer cells in thin material alone.
  CHECK(thin_in(sheet, 0.999 * thin.enough).share == 0);
  CHECK(thin_in(sheet, 0.05, 2).share == 0);
}

TEST_CASE("thick bodies are not thin, in any place and size") {
  for (const double size : {1e-3, 1.0, 1e4}) {
    TriangleMesh block = make_block({size, size, size}, size / 4);
    CHECK(thin_in(block, size / 5).share == 0);
    for (Vec3& p : block.vertices) p -= Vec3(3 * size, size, 0.5 * size);
    CHECK(thin_in(block, size / 5).share == 0);
  }
  CHECK(thin_in(make_sphere(6), 0.3).share < 0.1);
}
