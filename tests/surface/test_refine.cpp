// Refinement of meshes.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& [a, b, c] : corners_of(mesh))
    longest = std::max({longest, (b - a).norm(), (c - b).norm(), (a - c).norm()});
  return longest;
}

}  // namespace

TEST_CASE("refined solids are solids of the same shape with short edges, in any place and proportion") {
  const Seeds these = seeds(12);
  for (std::uint64_t seed = these.first; seed < these.first + static_cast<std::uint64_t>(these.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TriangleMesh mesh = random.uniform() < 0.5 ? make_block({2, 1, 1}, 2) : make_sphere(2);
    const Vec3 stretch(1 + 30 * random.uniform(), 1, 0.05 + random.uniform()),
        away = 1e3 * Vec3(random.uniform(), random.uniform(), random.uniform());
    for (Vec3& p : mesh.vertices) p = p.cwiseProduct(stretch) + away;
    const double longest = (0.02 + 0.3 * random.uniform()) * bounding_box(mesh).diagonal();
    const TriangleMesh fine = refined(mesh, longest);
    REQUIRE_NOTHROW(require_solid(fine));
    CHECK(longest_edge(fine) <= longest);
    CHECK(signed_volume(fine) == Approx(signed_volume(mesh)).epsilon(1e-9));
    CHECK(area(fine) == Approx(area(mesh)).epsilon(1e-9));
    CHECK(std::equal(mesh.vertices.begin(), mesh.vertices.end(), fine.vertices.begin()));
    CHECK(fine.source.empty());
  }
}

TEST_CASE("a mesh that is fine enough stays as it is, and what one carries is where it was") {
  TriangleMesh mesh = make_block({2, 1, 1}, 1);
  mesh.attributes.group_names = {"a", "b"};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& row = mesh.attributes.uv.emplace_back();
    for (int k = 0; k < 3; ++k) row[k] = mesh.vertices[mesh.triangles[t][k]].head<2>();
    mesh.attributes.group.push_back(static_cast<std::int32_t>(t % 2));
  }
  const TriangleMesh same = refined(mesh, 10);
  CHECK(same.triangles == mesh.triangles);
  CHECK(same.attributes == mesh.attributes);
  const TriangleMesh fine = refined(mesh, 0.2);
  REQUIRE(fine.attributes.uv.size() == fine.triangles.size());
  for (std::size_t t = 0; t < fine.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      CHECK((fine.attributes.uv[t][k] - fine.vertices[fine.triangles[t][k]].head<2>()).norm() < 1e-12);
  CHECK(std::count(fine.attributes.group.begin(), fine.attributes.group.end(), 0) > 10);
}

TEST_CASE("edges that rounding lets no middle have stay, and too many triangles are refused") {
  TriangleMesh mesh = make_block({2, 1, 1}, 2);
  CHECK_THROWS_AS(refined(mesh, 1e-5), InputError);
  for (Vec3& p : mesh.vertices) p = 1e-15 * p + Vec3::Constant(7);
  CHECK(refined(mesh, 1e-18).triangles.size() < 1000);
}
