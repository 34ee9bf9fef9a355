#include <catch2/catch.hpp>

#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

// A cube of eight corners and twelve triangles, and four of its corners as a wall through its
// middle.
TriangleMesh cube() { return make_block({1, 1, 1}, 2); }

std::string refusal(const TriangleMesh& mesh) {
  try {
    require_solid(mesh);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a skin is its own derived surface") {
  const TriangleMesh mesh = make_pumpkin(6);
  const Complex k = Complex::from_skin(mesh);
  CHECK(check_complex(k, SelfIntersections::find).good());
  const TriangleMesh derived = k.two_sided();
  CHECK(derived.triangles.size() == mesh.triangles.size());
  CHECK(signed_volume(derived) == Approx(signed_volume(mesh)).epsilon(1e-14));
  CHECK(find_pieces(k).count == 1);
}

TEST_CASE("a wall across a cube's diagonal makes two pieces, and reading it back changes nothing") {
  const TriangleMesh mesh = cube();
  const Complex before = Complex::from_skin(mesh);
  // The wall stands on a closed loop of the cube's own edges: find two opposite parallel edges that
  // are diagonal to each other, and the two face diagonals that join them.
  const auto id = [&](double x, double y, double z) {
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (mesh.vertices[v] == Vec3(x, y, z)) return VertexId(v);
    return VertexId();
  };
  for (int variant = 0; variant < 6; ++variant) {
    const int axis = variant / 2;
    const auto corner = [&](double a, double b, double c) {
      double p[3];
      p[axis] = a;
      p[(axis + 1) % 3] = b;
      p[(axis + 2) % 3] = c;
      return id(p[0], p[1], p[2]);
    };
    const double s = variant % 2;
    const VertexId a = corner(0, 0, s), b = corner(1, 0, s), c = corner(1, 1, 1 - s), d = corner(0, 1, 1 - s);
    if (before.faces_around(a, d).empty() || before.faces_around(b, c).empty())
      continue;  // that face's diagonal runs the other way
    Complex k = before;
    ComplexEdit edit;
    edit.new_faces.push_back({{a, b, c}, 1, FaceId()});
    edit.new_faces.push_back({{a, c, d}, 1, FaceId()});
    const std::uint32_t base = k.face_count();
    const auto ring = [&](VertexId u, VertexId v, std::uint32_t face) {
      // Material is before the first face of a skin ring in one of the two ways to insert: try
      // both.
      const auto old = k.faces_around(u, v);
      ComplexEdit::RadialOrder r{std::min(u, v), std::max(u, v), {old[0], FaceId(base + face), old[1]}};
      return r;
    };
    const std::pair<VertexId, VertexId> edges[4] = {{a, b}, {b, c}, {c, d}, {d, a}};
    const std::uint32_t owner[4] = {0, 0, 1, 1};
    bool done = false;
    CrackDelta delta;
    for (int mask = 0; mask < 16 && !done; ++mask) {
      edit.radial_orders.clear();
      for (int e = 0; e < 4; ++e) {
        auto r = ring(edges[e].first, edges[e].second, owner[e]);
        if (mask >> e & 1) std::swap(r.faces[0], r.faces[2]);
        edit.radial_orders.push_back(r);
      }
      const auto unchanged = k.two_sided();
      try {
        delta = k.apply(edit);
        done = true;
      } catch (const GeometryError&) {
        CHECK(k.two_sided().triangles == unchanged.triangles);  // all or nothing
      }
    }
    REQUIRE(done);
    CHECK(check_complex(k, SelfIntersections::find).good());
    const Pieces pieces = find_pieces(k);
    REQUIRE(pieces.count == 2);
    CHECK(pieces.volume[0] == Approx(0.5).epsilon(1e-14));
    CHECK(delta.new_crack_faces.size() == 2);
    CHECK(delta.new_surface_vertices.size() == 4);
    const TriangleMesh surface = k.two_sided();
    const Complex again = Complex::from_two_sided(surface);
    CHECK(again.two_sided().triangles == surface.triangles);
    CHECK(find_pieces(again).count == 2);
    Complex grown = before;
    grown.apply(before.difference(again));
    CHECK(grown.two_sided().triangles.size() == surface.triangles.size());
    CHECK(find_pieces(grown).count == 2);
    return;
  }
  FAIL("no face diagonals fit");
}

TEST_CASE("a cavity belongs to the piece around it") {
  TriangleMesh mesh = make_sphere(4);
  const auto inner = make_sphere(3);
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& p : inner.vertices) mesh.vertices.push_back(0.4 * p);
  for (const auto& t : inner.triangles) mesh.triangles.push_back({base + t[0], base + t[2], base + t[1]});
  const Complex k = Complex::from_skin(mesh);
  const Pieces pieces = find_pieces(k);
  REQUIRE(pieces.count == 1);
  CHECK(pieces.volume[0] == Approx(signed_volume(mesh)).epsilon(1e-12));
}

TEST_CASE("what is no solid is refused, and each fault is named") {
  TriangleMesh open = cube();
  open.triangles.pop_back();
  CHECK_THAT(refusal(open), Catch::Contains("open"));
  TriangleMesh inside_out = cube();
  for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
  CHECK_THAT(refusal(inside_out), Catch::Contains("inside out"));
  TriangleMesh flipped = cube();
  std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
  CHECK_THAT(refusal(flipped), Catch::Contains("orient"));
  TriangleMesh nan = cube();
  nan.vertices[2].y() = std::nan("");
  CHECK_THAT(refusal(nan), Catch::Contains("not a finite number"));
  TriangleMesh crossing = cube();
  const auto other = make_block({1, 1, 1}, 2);
  for (const auto& p : other.vertices) crossing.vertices.push_back(p + Vec3(0.5, 0.25, 0.125));
  for (const auto& t : other.triangles) crossing.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  CHECK_THAT(refusal(crossing), Catch::Contains("intersect"));
  TriangleMesh flat = cube();
  flat.vertices[0] = flat.vertices[1];
  CHECK_THAT(refusal(flat), Catch::Contains("degenerate"));
  CHECK_THAT(refusal({}), Catch::Contains("empty"));
  CHECK(refusal(cube()).empty());
}

TEST_CASE("procedural models are solids at any resolution") {
  for (const int f : {3, 8, 14}) {
    CHECK(refusal(make_pumpkin(f)).empty());
    CHECK(refusal(make_apple(f)).empty());
  }
  CHECK(refusal(make_polyp(16)).empty());
  for (char c = 'A'; c <= 'Z'; ++c) {
    CAPTURE(c);
    CHECK(refusal(make_letter(c, 0.25, 14)).empty());
  }
  CHECK_THROWS_AS(make_letter('?', 0.25, 14), InputError);
}

TEST_CASE("A triangle that names a shared vertex twice crosses", "[check]") {
  const Vec3 at[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto crosses = [&](std::array<std::uint32_t, 3> f, std::array<std::uint32_t, 3> g) {
    return faces_cross(f, {at[f[0]], at[f[1]], at[f[2]]}, g, {at[g[0]], at[g[1]], at[g[2]]});
  };
  CHECK(!crosses({0, 1, 2}, {0, 1, 3}));
  CHECK(!crosses({0, 1, 2}, {0, 3, 1}));
  CHECK(crosses({0, 1, 2}, {2, 1, 0}));
  CHECK(crosses({0, 0, 1}, {0, 2, 3}));
  CHECK(crosses({0, 2, 3}, {0, 0, 1}));
  CHECK(crosses({0, 0, 1}, {1, 0, 1}));
  CHECK(crosses({0, 0, 0}, {0, 0, 0}));
}
