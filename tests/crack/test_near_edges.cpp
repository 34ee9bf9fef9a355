// Sheets that run beside edges of the mesh: with CrackOptions::snap_edges they go through them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "surface/edit_group.h"

using namespace geo;

namespace {

constexpr double reach = 1e-4;  // of the size

// A front that moves through a block in a plane of the mesh, but for noise.
struct Case {
  Complex complex;
  std::vector<std::vector<Vec3>> steps;
};

Case random_case(std::uint64_t seed) {
  Random random(seed);
  const int squares = 2 + static_cast<int>(random.below(4));
  const Vec3 size(1, random.uniform(0.6, 1.4), random.uniform(0.6, 1.4));
  TriangleMesh mesh = make_block(size, 1.0 / squares);
  Case c{Complex::from_skin(mesh), {}};
  // Anywhere in the block's own lines of x, and beside them by less than the reach.
  const double line = (1 + double(random.below(static_cast<std::uint32_t>(squares - 1)))) / squares;
  const double noise = 0.3 * reach * c.complex.extent().diagonal() * std::pow(10.0, -random.uniform(0.0, 10.0));
  const double x = line + (random.below(2) == 0 ? 0 : random.uniform(-noise, noise));
  const std::uint32_t points = 3 + random.below(6), steps = 2 + random.below(6);
  for (std::uint32_t s = 0; s <= steps; ++s) {
    const double y = size.y() * (-0.1 + 1.2 * s / steps);
    auto& step = c.steps.emplace_back();
    for (std::uint32_t i = 0; i < points; ++i)
      step.push_back({x + random.uniform(-noise, noise), y, size.z() * (-0.1 + 1.2 * i / (points - 1))});
  }
  return c;
}

double lowest_face(const Complex& k) {
  double lowest = 1;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f))) lowest = std::min(lowest, height_of(k.corners(FaceId(f))));
  return lowest;
}

bool are_equal(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles;
}

}  // namespace

TEST_CASE("a sheet beside lines of the mesh snaps to them, and leaves no slivers") {
  const Seeds all = seeds(300);
  double lowest = 1;
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Case c = random_case(seed);
    FrontState front = begin_front(c.steps[0], false, 1);
    for (std::size_t s = 1; s < c.steps.size(); ++s) {
      const TriangleMesh before = c.complex.two_sided();
      const FrontState front_before = front;
      Complex tried = c.complex;
      const CrackDelta delta = advance(tried, front, c.steps[s], {.snap_edges = reach});
      // The delta names what differs, and undo() reverts all of it.
      for (const FaceId f : delta.removed_faces) REQUIRE(c.complex.alive(f));
      for (const FaceId f : delta.new_faces) REQUIRE(tried.alive(f));
      REQUIRE(tried.live_face_count() + delta.removed_faces.size() ==
              c.complex.live_face_count() + delta.new_faces.size());
      if (!delta.empty()) {
        Complex undone = tried;
        undone.undo();
        REQUIRE(are_equal(undone.two_sided(), before));
        front = front_before;
        REQUIRE(advance(undone, front, c.steps[s], {.snap_edges = reach}).new_faces == delta.new_faces);
        REQUIRE(are_equal(undone.two_sided(), tried.two_sided()));
      }
      c.complex = std::move(tried);
    }
    const auto report = check_complex(c.complex, SelfIntersections::find);
    INFO(report.first_problem);
    REQUIRE(report.good());
    CHECK(find_pieces(c.complex).count == 2);
    lowest = std::min(lowest, lowest_face(c.complex));
    CHECK(lowest_face(c.complex) > 0.5 * reach);
  }
  INFO("the lowest face is " << lowest << " high");
  CHECK(lowest > 0.5 * reach);
}

TEST_CASE("edits of a group are reverted together, by its destructor unless they are kept") {
  Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.5));
  const TriangleMesh before = k.two_sided();
  // Divides face 0 at its middle.
  const auto divide_first = [&] {
    FaceId f(std::uint32_t(0));
    while (!k.alive(f)) f = FaceId(f.value + 1);
    const auto& v = k.face(f).v;
    const auto t = k.corners(f);
    ComplexEdit edit;
    edit.new_vertices = {(t[0] + t[1] + t[2]) / 3};
    edit.removed_faces = {f};
    const VertexId middle(k.vertex_count());
    for (std::size_t i = 0; i < 3; ++i)
      edit.new_faces.push_back({.v = {v[i], v[(i + 1) % 3], middle}, .crack = 0, .parent = f});
    k.apply(edit);
  };
  {
    Complex::EditGroup group(k);
    divide_first();
    divide_first();
  }
  CHECK(are_equal(k.two_sided(), before));
  divide_first();
  const TriangleMesh once = k.two_sided();
  {
    Complex::EditGroup group(k);
    divide_first();
    divide_first();
    group.keep();
  }
  CHECK(k.live_face_count() == before.triangles.size() + 6);
  k.undo();
  CHECK(are_equal(k.two_sided(), once));
  { const Complex::EditGroup empty(k); }
  CHECK_THROWS(k.undo());
}

namespace {

struct Plane {
  Vec3 place, normal;
};

// The shares of the volume of a convex body between the planes, descending: of points in it.
std::vector<double> shares_between(const Complex& k, const std::vector<Plane>& planes, Random& random) {
  constexpr int points = 20000;
  std::vector<std::array<Vec3, 3>> skin;
  for (std::uint32_t f = 0; f < k.face_count(); ++f) skin.push_back(k.corners(FaceId(f)));
  std::map<unsigned, int> counts;
  for (int found = 0; found < points;) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(k.extent().lo[axis], k.extent().hi[axis]);
    const bool is_inside =
        std::all_of(skin.begin(), skin.end(), [&](const auto& t) { return orient3d(t[0], t[1], t[2], p) <= 0; });
    if (!is_inside) continue;
    ++found;
    unsigned sides = 0;
    for (const Plane& plane : planes) sides = 2 * sides + ((p - plane.place).dot(plane.normal) > 0 ? 1 : 0);
    ++counts[sides];
  }
  std::vector<double> shares;
  for (const auto& [sides, count] : counts) shares.push_back(double(count) / points);
  std::sort(shares.rbegin(), shares.rend());
  return shares;
}

// A stroke of a straight front in a plane, from outside to outside, in some steps.
void stroke(Complex& k, const Plane& plane, std::int32_t crack, double snap_edges, Random& random) {
  const double size = k.extent().diagonal();
  const Vec3 along = plane.normal.cross(random.direction()).normalized(), ahead = plane.normal.cross(along);
  const std::uint32_t points = 2 + random.below(6), steps = 2 + random.below(5);
  const auto step_at = [&](std::uint32_t s) {
    std::vector<Vec3> step;
    for (std::uint32_t i = 0; i < points; ++i)
      step.push_back(plane.place + size * ((1.6 * i / (points - 1) - 0.8) * along + (1.6 * s / steps - 0.8) * ahead));
    return step;
  };
  FrontState front = begin_front(step_at(0), false, crack);
  // A step may have gone a part of its way: the last ones go the rest. Without a change, K has no
  // new number, either: those who follow it learn of none.
  for (std::uint32_t s = 1; s <= steps + 4; ++s) {
    const std::uint32_t faces = k.face_count();
    const std::uint32_t vertices = k.surface_vertex_count();
    if (!advance(k, front, step_at(std::min(s, steps)), {.snap_edges = snap_edges}).empty()) continue;
    CHECK(k.face_count() == faces);
    CHECK(k.surface_vertex_count() == vertices);
  }
}

}  // namespace

TEST_CASE("strokes divide a convex body as their planes do, beside walls of older cracks, too") {
  const Seeds all = seeds(200);
  int refused = 0, crossing = 0;
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Complex k = Complex::from_skin(random.below(2) == 0 ? make_block({1, 1.2, 0.8}, random.uniform(0.25, 0.5))
                                                        : make_sphere(static_cast<int>(2 + random.below(3))));
    const Complex whole = k;
    const double size = k.extent().diagonal();
    const double snap_edges = std::pow(10.0, random.uniform(-5, -3));
    std::vector<Plane> planes;
    try {
      for (std::int32_t crack = 1; crack <= 3; ++crack) {
        // A plane anywhere, or one nearly in the last one.
        const Vec3 middle = 0.5 * (k.extent().lo + k.extent().hi);
        Plane plane{.place = middle + 0.2 * size * random.uniform() * random.direction(), .normal = random.direction()};
        if (crack > 1 && random.below(2) == 0) {
          plane = planes.back();
          plane.normal += std::pow(10.0, random.uniform(-3, -0.3)) * random.direction();
          plane.normal.normalize();
        }
        planes.push_back(plane);
        stroke(k, plane, crack, snap_edges, random);
      }
    } catch (const GeometryError&) {
      ++refused;
      continue;
    }
    const Pieces pieces = find_pieces(k);
    const std::vector<double> expected = shares_between(whole, planes, random);
    std::vector<double> found = pieces.volume;
    for (double& volume : found) volume /= std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
    std::sort(found.rbegin(), found.rend());
    found.resize(std::max(found.size(), expected.size()), 0);
    // 20,000 points: 0.018 are five standard deviations of a half.
    for (std::size_t i = 0; i < found.size(); ++i)
      CHECK(std::abs(found[i] - (i < expected.size() ? expected[i] : 0)) < 0.018);
    crossing += expected.size() > 2;
  }
  CHECK(refused <= all.count / 50);
  CHECK(crossing > all.count / 2);
}
