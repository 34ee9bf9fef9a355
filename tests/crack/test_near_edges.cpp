// Sheets that run beside edges of the mesh: with CrackOptions::snap_edges they go through them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"
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

// The edges of faces of cracks that no other face has: where sheets end in the material.
std::set<std::pair<std::uint32_t, std::uint32_t>> borders_of(const Complex& k) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> faces;
  for (std::uint32_t f = 0; f < k.face_count(); ++f) {
    if (!k.alive(FaceId(f))) continue;
    const auto& v = k.face(FaceId(f)).v;
    for (std::size_t i = 0; i < 3; ++i) ++faces[std::minmax(v[i].value, v[(i + 1) % 3].value)];
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> borders;
  for (const auto& [edge, count] : faces)
    if (count == 1) borders.insert(edge);
  return borders;
}

// Takes away the edges of which a front consists.
void omit(std::set<std::pair<std::uint32_t, std::uint32_t>>& borders, const FrontState& front) {
  for (const auto& segment : front.segments)
    for (std::size_t i = 0; i + 1 < segment.size(); ++i)
      if (segment[i].id.valid() && segment[i + 1].id.valid())
        borders.erase(std::minmax(segment[i].id.value, segment[i + 1].id.value));
}

}  // namespace

TEST_CASE("a sheet ends in the material at its front alone, beside walls of older cracks, too") {
  const Seeds all = seeds(30);
  std::size_t inner_fronts = 0, refused = 0;
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double spacing = random.uniform(0.25, 0.5);
    Complex k = Complex::from_skin(random.below(2) == 0 ? make_block({1, 1.2, 0.8}, spacing)
                                                        : make_sphere(static_cast<int>(2 + random.below(3))));
    const Vec3 middle = 0.5 * (k.extent().lo + k.extent().hi);
    const double size = k.extent().diagonal();
    const double snap_edges = std::pow(10.0, random.uniform(-5, -3));
    Vec3 normal = random.direction(), place = middle + 0.2 * size * random.uniform() * random.direction();
    CrackStats stats;
    for (int stroke = 0; stroke < 3 && stats.joined_specks == 0; ++stroke) {
      // A stroke of its own, or one in nearly the last one's plane.
      if (random.below(2) == 0) {
        normal = random.direction();
        place = middle + 0.2 * size * random.uniform() * random.direction();
      }
      normal = (normal + std::pow(10.0, random.uniform(-6, -1)) * random.direction()).normalized();
      const Vec3 along = normal.cross(random.direction()).normalized(), ahead = normal.cross(along);
      const std::uint32_t points = 2 + random.below(6), steps = 2 + random.below(5);
      const double end = stroke == 2 && random.below(2) == 0 ? random.uniform(-0.2, 0.2) : 0.8;
      const auto step_at = [&](std::uint32_t s) {
        std::vector<Vec3> step;
        for (std::uint32_t i = 0; i < points; ++i)
          step.push_back(place +
                         size * ((-0.8 + 1.6 * i / (points - 1)) * along + (-0.8 + (end + 0.8) * s / steps) * ahead));
        return step;
      };
      FrontState front = begin_front(step_at(0), false, stroke + 1);
      // A step may have gone a part of its way; the last ones go the rest.
      for (std::uint32_t s = 1; s <= steps + 4; ++s) {
        try {
          advance(k, front, step_at(std::min(s, steps)), {.snap_edges = snap_edges}, &stats);
        } catch (const GeometryError&) {
          ++refused;  // the next step begins where this one did
          continue;
        }
        if (stats.joined_specks > 0) break;  // they are opened towards what is beside them
        auto borders = borders_of(k);
        const bool inner = !borders.empty();
        omit(borders, front);
        INFO("stroke " << stroke << ", step " << s << " of " << steps << ", refused " << refused);
        REQUIRE(borders.empty());
        inner_fronts += inner;
      }
    }
    const auto report = check_complex(k, SelfIntersections::find);
    INFO(report.first_problem);
    REQUIRE(report.good());
  }
  INFO(inner_fronts << " steps end in the material, " << refused << " are refused");
  CHECK(inner_fronts > static_cast<std::size_t>(all.count));
  CHECK(refused < inner_fronts / 10);
}
