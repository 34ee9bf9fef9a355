// Impacts: parts fill the solid, are closed, and break again; budgets; several materials.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/impact.h"

using namespace geo;

namespace {

// Options by which the number of pieces is this one for any energy.
ImpactOptions pieces(int count) {
  ImpactOptions options;
  options.toughness = 1e-9;
  options.max_pieces = count;
  return options;
}

// The parts that are there: closed, and together as large as the solid.
std::vector<const BrokenPart*> checked_parts(const Breaking& breaking) {
  std::vector<const BrokenPart*> parts;
  double volume = 0;
  for (const BrokenPart& part : breaking.parts()) {
    if (part.divided) continue;
    parts.push_back(&part);
    volume += part.solid.volume();
    const SurfaceReport report = check_surface(part.solid.mesh(), SelfIntersections::ignore);
    CHECK(report.closed);
    CHECK(report.manifold);
    CHECK(report.oriented);
  }
  CHECK(volume == Approx(breaking.parts()[0].solid.volume()).epsilon(1e-9));
  return parts;
}

Impact blow(const TriangleMesh& mesh, Random& random) {
  const Vec3 point = mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))];
  return {.point = point, .direction = random.direction(), .energy = 1};
}

// A block whose lower half is of another material.
TriangleMesh two_materials() {
  TriangleMesh mesh = make_block(Vec3(1, 1, 1), 0.25);
  mesh.attributes.group_names = {"stone", "wood"};
  for (const Triangle& t : mesh.triangles) {
    mesh.attributes.group.push_back(mesh.vertices[t[0]].z() + mesh.vertices[t[1]].z() + mesh.vertices[t[2]].z() > 1.5);
    auto& uv = mesh.attributes.uv.emplace_back();
    for (int k = 0; k < 3; ++k) uv[k] = mesh.vertices[t[k]].head<2>();
  }
  return mesh;
}

}  // namespace

TEST_CASE("parts of broken solids fill them, are closed, and are as many as the sites", "[impact]") {
  const auto [first, count] = seeds(6);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const TriangleMesh mesh = random.below(2) ? make_pumpkin(8) : make_letter(char('A' + random.below(26)), 0.3, 12);
    Breaking breaking(Breakable(mesh), blow(mesh, random), pieces(12));
    CHECK(breaking.advance(1e9));
    const auto parts = checked_parts(breaking);
    CHECK(parts.size() >= 10);
    for (const BrokenPart* part : parts) {
      CHECK(part->whole);
      CHECK(part->parent == 0);
      CHECK(part->hulls.size() == 1);
    }
  }
}

TEST_CASE("with the full guard, pieces are valid models", "[impact]") {
  const TriangleMesh mesh = make_letter('E', 0.3, 12);
  ImpactOptions options = pieces(10);
  options.guard = ImpactGuard::full;
  Breaking breaking(Breakable(mesh), {.point = mesh.vertices[5], .direction = Vec3(1, 2, 3), .energy = 1}, options);
  breaking.advance(1e9);
  for (const BrokenPart* part : checked_parts(breaking)) CHECK_NOTHROW(require_solid(part->solid.mesh()));
}

TEST_CASE("a break in the smallest steps has parts that fill the solid after each", "[impact]") {
  const auto [first, count] = seeds(4);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const TriangleMesh mesh = random.below(2) ? make_pumpkin(6) : make_letter('S', 0.4, 12);
    Breaking breaking(Breakable(mesh), blow(mesh, random), pieces(9));
    std::size_t calls = 1, before = 1;
    for (; !breaking.advance(0); ++calls) {
      REQUIRE(calls < 200);
      const auto parts = checked_parts(breaking);
      CHECK(parts.size() >= before);
      before = parts.size();
    }
    CHECK(checked_parts(breaking).size() >= 8);
    CHECK(calls > 9);  // a division for each site but one, and hulls
  }
}

TEST_CASE("pieces of breaks in short calls are valid models, and break again", "[impact]") {
  const auto [first, count] = seeds(4);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const TriangleMesh mesh = random.below(2) ? make_pumpkin(8) : make_letter(char('A' + random.below(26)), 0.3, 12);
    Breaking breaking(Breakable(mesh), blow(mesh, random), pieces(64));
    while (!breaking.advance(random.uniform(0, 0.02))) continue;
    for (const BrokenPart* part : checked_parts(breaking)) {
      CHECK_NOTHROW(require_solid(part->solid.mesh()));
      Breaking again(part->solid, {.point = bounding_box(part->solid.mesh()).center(), .energy = 1}, pieces(3));
      while (!again.advance(random.uniform(0, 0.005))) continue;
      const auto shards = checked_parts(again);
      CHECK(shards.size() > 1);
      for (const BrokenPart* shard : shards) CHECK_NOTHROW(require_solid(shard->solid.mesh()));
    }
  }
}

TEST_CASE("pieces are small at the impact, and long along its direction", "[impact]") {
  const TriangleMesh mesh = make_block(Vec3(1, 1, 1), 0.2);
  Breaking breaking(Breakable(mesh), {.point = Vec3(0, 0, 0), .direction = Vec3(0, 0, 1), .energy = 1}, pieces(40));
  breaking.advance(1e9);
  std::vector<std::pair<double, double>> sizes;  // distance from the impact, volume
  double along = 0, across = 0;
  for (const BrokenPart* part : checked_parts(breaking)) {
    const Box3 box = bounding_box(part->solid.mesh());
    sizes.emplace_back(box.center().norm(), part->solid.volume());
    along += box.hi.z() - box.lo.z();
    across += 0.5 * (box.hi.x() - box.lo.x() + box.hi.y() - box.lo.y());
  }
  std::sort(sizes.begin(), sizes.end());
  double near = 0, far = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    near += sizes[i].second;
    far += sizes[sizes.size() - 1 - i].second;
  }
  CHECK(far > 3 * near);
  CHECK(along > 1.2 * across);
}

TEST_CASE("energy decides how many pieces there are, and too little breaks nothing", "[impact]") {
  const Breakable solid(make_block(Vec3(1, 1, 1), 0.5));
  const auto count = [&](double energy) {
    Breaking breaking(solid, {.point = Vec3(0, 0, 1), .direction = Vec3(0, 0, -1), .energy = energy});
    breaking.advance(1e9);
    return checked_parts(breaking).size();
  };
  CHECK(count(0) == 1);
  CHECK(count(100) == 1);
  CHECK(count(400) > 1);
  CHECK(count(800) > count(400));
  CHECK(count(1e9) >= 60);  // up to max_pieces
}

TEST_CASE("pieces keep materials and texture coordinates, and break again", "[impact]") {
  const TriangleMesh mesh = two_materials();
  const Impact impact{.point = Vec3(0.5, 0.5, 1), .direction = Vec3(0, 0, -1), .energy = 1};
  Breaking first(Breakable(mesh), impact, pieces(6));
  first.advance(1e9);
  for (const BrokenPart* part : checked_parts(first)) {
    Breaking second(part->solid, {.point = bounding_box(part->solid.mesh()).center(), .energy = 1}, pieces(4));
    second.advance(1e9);
    for (const BrokenPart* shard : checked_parts(second)) {
      const TriangleMesh& piece = shard->solid.mesh();
      const auto& names = piece.attributes.group_names;
      REQUIRE(names.size() == 3);
      for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
        const bool inner = names[static_cast<std::size_t>(piece.attributes.group[t])] == crack_group;
        CHECK(inner == (piece.patch[t] != 0));
        CHECK(inner == (piece.source[t] == ~0u));
        if (inner) continue;
        for (int k = 0; k < 3; ++k)
          CHECK((piece.attributes.uv[t][k] - piece.vertices[piece.triangles[t][k]].head<2>()).norm() < 1e-9);
      }
    }
  }
}

TEST_CASE("a break does not depend on what was broken before, and refuses bad options", "[impact]") {
  const TriangleMesh mesh = make_pumpkin(6);
  const Breakable solid(mesh);
  const Impact impact{.point = mesh.vertices[7], .direction = Vec3(1, 0, 0), .energy = 1};
  Breaking first(solid, impact, pieces(7)), second(solid, impact, pieces(7));
  first.advance(1e9);
  second.advance(1e9);
  REQUIRE(first.parts().size() == second.parts().size());
  for (std::size_t i = 0; i < first.parts().size(); ++i)
    CHECK(first.parts()[i].solid.mesh().vertices == second.parts()[i].solid.mesh().vertices);
  Impact bad = impact;
  bad.energy = std::nan("");
  CHECK_THROWS_AS(Breaking(solid, bad), InputError);
  bad = impact;
  bad.point.x() = HUGE_VAL;
  CHECK_THROWS_AS(Breaking(solid, bad), InputError);
  CHECK_THROWS_AS(Breaking(solid, impact, pieces(1)), InputError);
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  CHECK_THROWS_AS(Breakable(open), InputError);
}
