// Shells: nesting and orientation, in checks and in repair.
#include "surface/shells.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

enum class Facing { outwards, inwards };

// Appends a scaled and moved copy.
void add(TriangleMesh& mesh, const TriangleMesh& shape, double scale, const Vec3& place, Facing facing) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& p : shape.vertices) mesh.vertices.push_back(place + scale * p);
  for (const auto& [a, b, c] : shape.triangles) {
    if (facing == Facing::outwards)
      mesh.triangles.push_back({a + first, b + first, c + first});
    else
      mesh.triangles.push_back({a + first, c + first, b + first});
  }
}

std::vector<ShellKind> kinds_of(const TriangleMesh& mesh) {
  std::vector<ShellKind> kinds;
  for (const Shell& shell : find_shells(mesh)) kinds.push_back(shell.kind);
  return kinds;
}

constexpr Facing out = Facing::outwards, in = Facing::inwards;

// Shells about one centre, from the outermost one.
TriangleMesh nested(const std::vector<Facing>& facings, const TriangleMesh& shape) {
  TriangleMesh mesh;
  double scale = 1;
  for (const Facing facing : facings) {
    add(mesh, shape, scale, Vec3::Zero(), facing);
    scale *= 0.7;
  }
  return mesh;
}

}  // namespace

TEST_CASE("the kind of each shell follows from its depth and its orientation") {
  const TriangleMesh ball = make_sphere(3);
  using Kinds = std::vector<ShellKind>;
  constexpr auto outer = ShellKind::outer, cavity = ShellKind::cavity, inverted = ShellKind::inverted,
                 hidden = ShellKind::hidden;
  CHECK(kinds_of(nested({out, in, out, in}, ball)) == Kinds{outer, cavity, outer, cavity});
  CHECK(kinds_of(nested({out, out, out, in}, ball)) == Kinds{outer, hidden, outer, cavity});
  CHECK(kinds_of(nested({in, out, in}, ball)) == Kinds{inverted, hidden, inverted});
  TriangleMesh beside;
  add(beside, ball, 1, {5, 0, 0}, out);
  add(beside, ball, 1, {0, 0, 0}, in);
  CHECK(kinds_of(beside) == Kinds{outer, inverted});
}

TEST_CASE("a surface with a shell of wrong orientation is no solid, and the message names the shell") {
  const TriangleMesh ball = make_sphere(3);
  const auto message = [](const TriangleMesh& mesh) {
    try {
      require_solid(mesh);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message(nested({out, in, out}, ball)) == "");
  CHECK_THAT(message(nested({in}, ball)), Catch::Contains("the surface is inside out"));
  CHECK_THAT(message(nested({in, out}, ball)), Catch::Contains("the surface is inside out"));
  CHECK_THAT(message(nested({out, out}, ball)),
             Catch::Contains("shell 2 (180 triangles, the first is 180) lies in the material of shell 1"));
  CHECK_THAT(message(nested({out, in, in}, ball)),
             Catch::Contains("shell 3 (180 triangles, the first is 360) is inside out, although it lies in a cavity"));
  TriangleMesh beside;
  for (int i = 0; i < 9; ++i) add(beside, ball, 1, {3.0 * i, 0, 0}, i % 2 == 0 ? out : in);
  CHECK_THAT(message(beside), Catch::Contains("4 of 9 shells are oriented wrongly") && Catch::Contains("and 1 more"));
}

TEST_CASE("a two-sided surface is tested by its skin: a shell inside out beside others is found after a cut") {
  TriangleMesh mesh;
  const TriangleMesh ball = make_sphere(3);
  add(mesh, ball, 1, Vec3::Zero(), out);
  add(mesh, ball, 0.5, {3, 0, 0}, in);
  const TriangleMesh two_sided = Complex::from_skin(mesh).two_sided();
  CHECK_THAT(check_surface(two_sided, SelfIntersections::find).first_problem, Catch::Contains("shell 2"));
}

TEST_CASE("orientation is exact where the volume is below rounding") {
  // A needle far from the origin: its volume is 1e-18 of that of a tetrahedron at the origin.
  TriangleMesh needle;
  needle.vertices = {{1e6, 1e6, 1e6}, {1e6 + 1, 1e6, 1e6}, {1e6, 1e6 + 0x1p-32, 1e6}, {1e6, 1e6, 1e6 + 0x1p-32}};
  needle.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  CHECK(find_shells(needle)[0].outwards);
  for (auto& t : needle.triangles) std::swap(t[1], t[2]);
  CHECK(!find_shells(needle)[0].outwards);
}

TEST_CASE("random nested shells: kinds are those that were made, wherever the shells are and in any order") {
  const auto [first, count] = seeds(30);
  const TriangleMesh ball = make_sphere(2), block = make_block({1, 1, 1}, 0.5);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    TriangleMesh mesh;
    std::vector<std::uint32_t> depth;
    std::vector<bool> outwards;
    const Vec3 origin(random.uniform(-1e4, 1e4), random.uniform(-1e4, 1e4), random.uniform(-1e4, 1e4));
    for (std::uint32_t nest = 0, nests = 1 + random.below(4); nest < nests; ++nest) {
      const std::uint32_t deepest = 1 + random.below(4);
      double scale = 1;
      for (std::uint32_t d = 0; d < deepest; ++d) {
        const TriangleMesh& shape = d == 0 ? block : ball;
        const Vec3 middle = origin + Vec3(4.0 * nest, 0, 0) + (d == 0 ? Vec3::Constant(-0.5) : Vec3::Zero());
        outwards.push_back(random.below(2) == 0);
        depth.push_back(d);
        add(mesh, shape, d == 0 ? 1 : scale, middle, outwards.back() ? out : in);
        scale = d == 0 ? 0.45 : 0.6 * scale;
      }
    }
    const auto shells = find_shells(mesh);
    REQUIRE(shells.size() == depth.size());
    for (std::size_t s = 0; s < shells.size(); ++s) {
      CHECK(shells[s].depth == depth[s]);
      CHECK(shells[s].outwards == outwards[s]);
      CHECK(shells[s].well_oriented() == (outwards[s] == (depth[s] % 2 == 0)));
    }
    TriangleMesh mended = mesh;
    repair(mended, {.inner = InnerShells::cavities});
    CHECK(check_surface(mended, SelfIntersections::find).first_problem == "");
    CHECK(mended.triangles.size() == mesh.triangles.size());
    repair(mesh);
    CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
  }
}

TEST_CASE("repair decides about inner shells by the winding number, or as it is told") {
  const TriangleMesh ball = make_sphere(4);
  const double one = signed_volume(ball), second = one * 0.7 * 0.7 * 0.7, third = second * 0.7 * 0.7 * 0.7;
  const auto volume = [&](const std::vector<Facing>& facings, InnerShells inner, RepairStats& done) {
    TriangleMesh mesh = nested(facings, ball);
    done = repair(mesh, {.inner = inner});
    CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
    return signed_volume(mesh);
  };
  RepairStats done;
  CHECK(volume({out, out}, InnerShells::by_orientation, done) == Approx(one));
  CHECK(done.dropped_shells == 1);
  CHECK(volume({out, out}, InnerShells::cavities, done) == Approx(one - second));
  CHECK(done.hollowed_shells == 1);
  CHECK(done.inverted_shells == 0);
  CHECK(volume({out, in}, InnerShells::filled, done) == Approx(one));
  CHECK(done.filled_shells == 1);
  // The cavity of a hidden part is hidden, too.
  CHECK(volume({out, out, in}, InnerShells::by_orientation, done) == Approx(one));
  CHECK(done.dropped_shells == 2);
  CHECK(volume({out, out, in}, InnerShells::cavities, done) == Approx(one - second + third));
  CHECK(volume({out, in, in}, InnerShells::by_orientation, done) == Approx(one - second + third));
  CHECK(done.inverted_shells == 1);
  // All inside out.
  CHECK(volume({in, out, in}, InnerShells::by_orientation, done) == Approx(one - second + third));
  CHECK(done.inverted_shells == 3);
}

TEST_CASE("ten thousand cavities in a block are found as such") {
  const TriangleMesh bolt = make_block({1, 1, 1}, 1);
  TriangleMesh mesh;
  add(mesh, make_block({1, 1, 1}, 1), 100, Vec3::Constant(-10), out);
  std::size_t bolts = 0;
  for (int x = 0; x < 22; ++x)
    for (int y = 0; y < 22; ++y)
      for (int z = 0; z < 21; ++z, ++bolts) add(mesh, bolt, 1, {1.5 * x, 1.5 * y, 1.5 * z}, in);
  REQUIRE(bolts > 10000);
  const auto shells = find_shells(mesh);
  CHECK(shells.size() == bolts + 1);
  CHECK(std::count_if(shells.begin(), shells.end(), [](const Shell& s) { return s.kind == ShellKind::cavity; }) ==
        static_cast<std::ptrdiff_t>(bolts));
}
